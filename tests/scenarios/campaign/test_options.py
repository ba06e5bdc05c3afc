"""Options of `schmidt campaign`: where it goes, and what it goes on with."""

from pathlib import Path

from scenarios.campaign.options import CampaignOptions
from tests.scenarios.studies.test_options import asked


def test_a_campaign_goes_to_a_folder_of_its_name_and_begins_anew() -> None:
    found = asked(CampaignOptions, "there/many.yaml")
    assert (found.file, found.out, found.folder) == (Path("there/many.yaml"), None, Path("out/many"))
    assert (found.jobs, found.scheduler, found.resume) == (None, None, False)
    assert "Missing argument 'FILE'" in asked(CampaignOptions)


def test_it_goes_on_where_it_is_told() -> None:
    found = asked(CampaignOptions, "many.yaml", "--out", "x", "--resume", "--jobs", "2")
    assert (found.folder, found.resume, found.jobs) == (Path("x"), True, 2)
