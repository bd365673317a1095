"""All solvers on a list of scenes, and the verdicts on every run."""

from __future__ import annotations

from dataclasses import dataclass

from validation.cases import Case
from validation.compare.checks import Check
from validation.execution.runs import Run


@dataclass(frozen=True)
class SceneComparison:
    """One scene: its runs by solver, and the verdicts on them."""

    case: Case
    runs: dict[str, Run]
    checks: list[Check]

    @property
    def passed(self) -> bool:
        """Whether every check on this scene passed."""
        return all(check.passed for check in self.checks)
