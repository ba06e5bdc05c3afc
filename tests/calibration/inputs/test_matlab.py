"""NumPy's archives are read in the words of MATLAB files."""

from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.matlab import columns_of, read_matlab


def test_an_archive_has_rows_columns_and_vectors(tmp_path: Path) -> None:
    path, q = tmp_path / "run.npz", np.arange(12.0).reshape(6, 2)
    np.savez(path, t=np.arange(6.0), q=q)
    (found,) = read_matlab(path, ["t", "q(:,2)"])
    np.testing.assert_array_equal(found["q(:,2)"], q[:, 1])
    assert columns_of(path) == ["t", "q(:,1)", "q(:,2)"]


def test_what_is_no_archive_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    path.write_text("time,q\n")
    with pytest.raises(CalibrationInputError, match="is not a NumPy archive of plain arrays"):
        read_matlab(path, ["q"])


def test_complex_numbers_are_no_column(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    np.savez(path, t=np.arange(6.0), q=np.arange(6.0) + 1j)
    with pytest.raises(CalibrationInputError, match="'q': holds complex numbers"):
        read_matlab(path, ["t", "q"])
