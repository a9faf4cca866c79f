"""Tables: columns of NumPy arrays, from the CSV files that the program writes."""

from __future__ import annotations

import csv
import os
from typing import TYPE_CHECKING, Any, Iterator, Mapping

import numpy as np

from ._library import InputError

if TYPE_CHECKING:
    import numpy.typing as npt

# Columns that are texts even where all of them look like numbers.
_texts = {"name", "hash", "status", "fault", "beyond_limits", "model", "phase", "result", "factor", "observation", "building"}


class Table(Mapping[str, "npt.NDArray[Any]"]):
    """A table by columns: `table["run_out_along_flow_m"]` is a NumPy array with an entry per row. NaN, or an empty text, where there is
    none. to_pandas() makes a DataFrame of it."""

    def __init__(self, columns: Mapping[str, npt.ArrayLike]) -> None:
        self._columns = {name: np.asarray(column) for name, column in columns.items()}
        lengths = {name: len(column) for name, column in self._columns.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"columns have lengths {lengths}; they must be alike")
        self._rows = next(iter(lengths.values()), 0)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Table:
        """From a CSV file with a heading."""
        try:
            with open(path, encoding="utf-8", newline="") as file:
                heading, *rows = csv.reader(file)
        except (OSError, ValueError, csv.Error) as error:
            raise InputError(f"{os.fsdecode(path)}: cannot be read as CSV: {getattr(error, 'strerror', None) or error}") from None
        for number, row in enumerate(rows, 2):
            if len(row) != len(heading):
                raise InputError(f"{os.fsdecode(path)}, line {number}: has {len(row)} fields; it must have {len(heading)}")
        return cls({name: _column(name, [row[k] for row in rows]) for k, name in enumerate(heading)})

    def __getitem__(self, column: str) -> npt.NDArray[Any]:
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(f"there is no column {column!r}; there are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns, as of a mapping; `rows` has that of rows."""
        return len(self._columns)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self._rows

    def row(self, index: int) -> dict[str, Any]:
        """A row as values by column."""
        return {name: column[index].item() for name, column in self._columns.items()}

    def to_pandas(self) -> Any:
        """A pandas.DataFrame. Needs pandas."""
        import pandas

        return pandas.DataFrame(self._columns)

    def __repr__(self) -> str:
        shown = [[name, *(_shown(column[k]) for k in range(min(self._rows, 6)))] for name, column in self._columns.items()]
        heading = f"<talus.Table: {self._rows} rows of {len(self._columns)} columns>"
        width = max((len(name) for name in self._columns), default=0)
        more = ", ..." if self._rows > 6 else ""
        return "\n".join([heading, *(f"  {name:{width}}  {', '.join(values)}{more}" for name, *values in shown)])


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, np.floating) else str(value)


def _column(name: str, texts: list[str]) -> npt.NDArray[Any]:
    given = {text for text in texts if text}
    if name in _texts or not given:
        return np.array(texts, np.str_) if name in _texts else np.full(len(texts), np.nan)
    if given <= {"yes", "no"} and "" not in texts:
        return np.array([text == "yes" for text in texts])
    try:
        if "" not in texts:
            return np.array([int(text) for text in texts])
    except ValueError:
        pass
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return np.array(texts, np.str_)
