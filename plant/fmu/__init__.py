"""One axis as a Functional Mock-up Unit (fmi-standard.org): the compiled kernel, without Python."""

from plant.fmu.archive import write as write
