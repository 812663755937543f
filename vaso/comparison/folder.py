"""The files of a comparison. They are complete after every run."""

from __future__ import annotations

from pathlib import Path

from vaso.comparison.result import Comparison
from vaso.comparison.running import UNSEEN_JOURNAL
from vaso.comparison.setup import Setup
from vaso.errors import OptimizerError
from vaso.optimizers.store import CHECKPOINT, JOURNAL

JSON, CSV, SVG, REPORT = "comparison.json", "comparison.csv", "comparison.svg", "report.html"


class Folder:
    """The folder of a comparison."""

    def __init__(self, out: str | Path) -> None:
        """Open the folder, and make it if it is not there.

        Raises:
            OptimizerError: It cannot be written.
        """
        self.path = Path(out)
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise self._unwritable(error) from error

    def found(self, setup: Setup) -> Comparison | None:
        """The comparison that is there already, if there is one.

        Args:
            setup: What the comparison that goes on has in common.

        Raises:
            VasoError: The file is damaged.
            OptimizerError: The runs are of another comparison.
        """
        if not (self.path / JSON).is_file():
            return None
        found = Comparison.read(self.path)
        if different := found.setup.differences(setup):
            raise OptimizerError(
                f"the runs in the folder are of another comparison: {', '.join(different)} differ",
                source=str(self.path),
                expected="the same skill, tasks, budget and models; optimizers and seeds may be "
                "added",
                hint="choose another folder, or do not resume",
            )
        return found

    def forget(self, name: str) -> None:
        """Make sure that a run does not go on from what an earlier comparison left in its folder.

        Raises:
            OptimizerError: It cannot be removed.
        """
        try:
            for file in (CHECKPOINT, JOURNAL, UNSEEN_JOURNAL):
                (self.path / name / file).unlink(missing_ok=True)
        except OSError as error:
            raise self._unwritable(error) from error

    def write(self, comparison: Comparison) -> None:
        """Write all files.

        Raises:
            OptimizerError: They cannot be written.
        """
        import json

        from vaso.comparison.page import comparison_html
        from vaso.optimizers.store import write_atomically

        texts = {
            JSON: json.dumps(comparison.to_json(), indent=1, ensure_ascii=False),
            CSV: comparison.to_csv(),
            SVG: comparison.svg(),
            REPORT: comparison_html(comparison),
        }
        try:
            for name, text in texts.items():
                write_atomically(self.path / name, text)
        except OSError as error:
            raise self._unwritable(error) from error

    def _unwritable(self, error: OSError) -> OptimizerError:
        return OptimizerError(
            f"the output folder cannot be written: {error}", source=str(self.path)
        )
