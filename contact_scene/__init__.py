"""Scene, form of results and control of a run, shared by the solvers of crosscontact; no way of solving."""

from contact_scene.adhesion import Adhesion, PowerRate, RateTable
from contact_scene.errors import SceneError, UnsupportedScene
from contact_scene.indenter import Cone, FlatPunch, Indenter, PowerLaw, Sphere, TabulatedProfile
from contact_scene.loading import (
    Approach,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Oscillate,
    Ramp,
    Segment,
    Step,
    Sweep,
    Table,
    Trigger,
)
from contact_scene.machine import Machine
from contact_scene.material import Branch, BulkRelaxation, Material, PowerLawRelaxation, StandardLinearSolid
from contact_scene.material_file import read_material, read_measured
from contact_scene.prony import DynamicData, PronyFit, RelaxationData, fit_prony
from contact_scene.run_control import LoadingCursor, RunMonitor
from contact_scene.scene import Layer, Scene, Units, read_scene, scene_from_dict, write_material, write_scene
from contact_scene.temperature_shift import WLF, Arrhenius, ShiftTable, at_temperature, read_shift_factors
from contact_scene.trace import (
    COLUMNS,
    Counters,
    Event,
    Outcome,
    OutcomeKind,
    SurfaceProfile,
    Trace,
    read_columns,
    write_trace,
)

__all__ = [
    "COLUMNS",
    "WLF",
    "Adhesion",
    "Approach",
    "Arrhenius",
    "Branch",
    "BulkRelaxation",
    "Cone",
    "Counters",
    "DynamicData",
    "Event",
    "FlatPunch",
    "Force",
    "ForceRamp",
    "Hold",
    "Indenter",
    "Layer",
    "Loading",
    "LoadingCursor",
    "Machine",
    "Material",
    "Oscillate",
    "Outcome",
    "OutcomeKind",
    "PowerLaw",
    "PowerLawRelaxation",
    "PowerRate",
    "PronyFit",
    "Ramp",
    "RateTable",
    "RelaxationData",
    "RunMonitor",
    "Scene",
    "SceneError",
    "Segment",
    "ShiftTable",
    "Sphere",
    "StandardLinearSolid",
    "Step",
    "SurfaceProfile",
    "Sweep",
    "Table",
    "TabulatedProfile",
    "Trace",
    "Trigger",
    "Units",
    "UnsupportedScene",
    "at_temperature",
    "fit_prony",
    "read_columns",
    "read_material",
    "read_measured",
    "read_scene",
    "read_shift_factors",
    "scene_from_dict",
    "write_material",
    "write_scene",
    "write_trace",
]
