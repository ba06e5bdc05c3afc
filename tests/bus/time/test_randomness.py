import subprocess
import sys

from bus.time import generator


def test_same_seed_and_name_same_numbers() -> None:
    assert generator(1, "axis_ra").random(4).tolist() == generator(1, "axis_ra").random(4).tolist()


def test_another_seed_or_name_other_numbers() -> None:
    draws = {float(generator(seed, name).random()) for seed in (1, 2) for name in ("a", "b", "1:a")}
    assert len(draws) == 6


def test_hash_seed_does_not_matter() -> None:
    code = "from bus.time import generator; print(generator(7, 'wire').integers(1 << 60))"
    seen = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert seen == {f"{generator(7, 'wire').integers(1 << 60)}\n"}
