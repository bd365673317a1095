"""A report: all evidence on a suite of scenes. :mod:`validation.report.write` gives it its forms."""

from __future__ import annotations

from dataclasses import dataclass

from validation.claims.all import checks as claim_checks
from validation.claims.claim import Finding
from validation.claims.evidence import Evidence
from validation.compare.regression import ReportComparison
from validation.compare.suite import SceneComparison
from validation.execution.run import Run
from validation.fields.cycle_fields import CycleFields
from validation.measure.check import Check
from validation.stability.checks import checks as stability_checks
from validation.stability.runner import StabilityMatrix


@dataclass(frozen=True)
class Claims:
    """The findings on the paper's statements, and the runs they rest on."""

    findings: tuple[Finding, ...]
    evidence: Evidence


@dataclass(frozen=True)
class Report:
    """The evidence; sections put it into words, tables and figures.

    Parameters
    ----------
    suite : str
    scenes : list of SceneComparison
    environment : dict
        Of ``provenance.stamp``.
    wall_seconds : float
    baseline : ReportComparison, optional
        What moved since an earlier report.
    claims : Claims, optional
        The paper's statements.
    fields : CycleFields, optional
        Fields in the body.
    stability : StabilityMatrix, optional
        Stiff and extreme cases.
    """

    suite: str
    scenes: list[SceneComparison]
    environment: dict[str, object]
    wall_seconds: float
    baseline: ReportComparison | None = None
    claims: Claims | None = None
    fields: CycleFields | None = None
    stability: StabilityMatrix | None = None

    @property
    def checks(self) -> list[Check]:
        """All checks, those of the paper's statements and of the matrix too."""
        checks = [check for scene in self.scenes for check in scene.checks]
        checks += [] if self.claims is None else claim_checks(self.claims.findings)
        return checks + ([] if self.stability is None else stability_checks(self.stability.cells))

    @property
    def runs(self) -> list[Run]:
        """All runs, those behind the paper's statements too; each once."""
        runs = [run for scene in self.scenes for run in scene.runs.values()]
        if self.claims is not None:
            runs += self.claims.evidence.runs.values()
        return list({(run.scene, run.solver): run for run in runs}.values())

    @property
    def failures(self) -> list[Check]:
        """Checks that are not passed."""
        return [check for check in self.checks if not check.passed]
