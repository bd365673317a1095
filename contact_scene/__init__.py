"""Scene, form of the results and control of a run, shared by all solvers; no numerical method."""

from contact_scene.adhesion import Adhesion
from contact_scene.errors import SceneError, UnsupportedScene
from contact_scene.indenter import Cone, FlatPunch, Indenter, PowerLaw, Sphere, TabulatedProfile
from contact_scene.loading import (
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
)
from contact_scene.material import Branch, BulkRelaxation, Material
from contact_scene.run_control import KeptState, LoadingCursor, RunMonitor
from contact_scene.scene import Scene
from contact_scene.scenefile import read_scene, scene_from_dict, write_scene
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
    "Adhesion",
    "Branch",
    "BulkRelaxation",
    "Cone",
    "Counters",
    "Event",
    "FlatPunch",
    "Force",
    "ForceRamp",
    "Hold",
    "Indenter",
    "KeptState",
    "Loading",
    "LoadingCursor",
    "Material",
    "Oscillate",
    "Outcome",
    "OutcomeKind",
    "PowerLaw",
    "Ramp",
    "RunMonitor",
    "Scene",
    "SceneError",
    "Segment",
    "Sphere",
    "Step",
    "SurfaceProfile",
    "Sweep",
    "Table",
    "TabulatedProfile",
    "Trace",
    "UnsupportedScene",
    "read_columns",
    "read_scene",
    "scene_from_dict",
    "write_scene",
    "write_trace",
]
