# SPDX-License-Identifier: Apache-2.0
"""Values from elsewhere, such as measurements or the figures of a publication, which are shown beside the points of an
experiment. The files have the columns of a table in CSV, so the table of an earlier experiment is one of them."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence

from roaml.exact_number import exact_fraction
from roaml.experiments.sweeps import Setting, Sweep
from roaml.record import Record
from roaml.suggest import close_names, did_you_mean

PROPERTY, VALUE, LOW, HIGH, SOURCE = "property", "value", "low", "high", "source"
"""The columns of a file, beside those of the parameters. The last three are optional."""


class BesideError(ValueError):
    """A file with values is not valid; the message states the reason."""


class BesideValue(Record, frozen=True):
    """A value from elsewhere.

    Attributes:
        source: from where.
        name: the property.
        setting: the parameters that the file states, of those of the experiment.
        low, high: the ends of its interval; `None` without one.
    """

    source: str
    name: str
    setting: Setting
    value: float
    low: float | None = None
    high: float | None = None

    def is_at(self, setting: Setting) -> bool:
        """Whether the value belongs to a point: it has the same parameters, apart from those that the file omits."""
        given = dict(setting)
        return all(is_same(given.get(name, value), value) for name, value in self.setting)


def is_same(one: str, other: str) -> bool:
    """Whether two texts are the same value: `0.5` and `1/2` are the same number."""
    numbers = exact_fraction(one), exact_fraction(other)
    return one == other if None in numbers else numbers[0] == numbers[1]


def read_beside(text: str, source: str, sweeps: Sequence[Sweep], properties: Sequence[str]) -> tuple[BesideValue, ...]:
    """The values in a CSV file for an experiment: those of its properties, with the values of the parameters that it
    does not vary.

    Args:
        text: a header, and a row for each value; other columns are ignored.
        source: the source of the values, unless the file has a column for it.

    Raises:
        BesideError: a column is missing, a value is not a number, or no row is about one of the properties.
    """
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    rows = csv.DictReader(lines, skipinitialspace=True)
    columns = [name for name in rows.fieldnames or () if name]
    for needed in (VALUE, PROPERTY, *(sweep.name for sweep in sweeps if len(sweep.values) > 1)):
        if needed not in columns:
            close = did_you_mean(close_names(needed, columns))
            raise BesideError(f"there is no column `{needed}`{close or '; add it to the first line'}")
    given = [sweep.name for sweep in sweeps if sweep.name in columns]
    fixed = {sweep.name: sweep.values[0] for sweep in sweeps if len(sweep.values) == 1}
    found, asked = [], False
    for row in rows:
        setting = tuple((name, (row[name] or "").strip()) for name in given)
        is_varied = any(name in fixed and not is_same(fixed[name], value) for name, value in setting)
        asked |= row[PROPERTY] in properties
        if row[PROPERTY] in properties and not is_varied:
            value = _number(row, VALUE)
            if value is not None:
                origin = row.get(SOURCE) or source
                found.append(BesideValue(origin, row[PROPERTY], setting, value, _number(row, LOW), _number(row, HIGH)))
    if not asked:
        names = " or ".join(f"`{name}`" for name in properties)
        raise BesideError(f"no row has the property {names}; compare the column `{PROPERTY}` with the experiment")
    return tuple(found)


def _number(row: Mapping[str, str | None], column: str) -> float | None:
    """A number in a row; `None` if the cell is empty."""
    text = (row.get(column) or "").strip()
    if not text:
        return None
    number = exact_fraction(text)
    if number is None:
        raise BesideError(f"the {column} `{text}` is not a number")
    return float(number)
