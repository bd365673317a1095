"""The question and the form of the answer, shared by all solvers; no numerical method lives here."""

from scene.adhesion import Adhesion
from scene.errors import SceneError, UnsupportedScene
from scene.indenter import Cone, FlatPunch, Indenter, PowerLaw, Sphere
from scene.indenter import Profile as TabulatedProfile
from scene.loading import Force, ForceRamp, Hold, Loading, Oscillate, Ramp, Segment, Step, Sweep, Table
from scene.material import Branch, BulkRelaxation, CreepCompliance, Material
from scene.scene import Scene
from scene.scenefile import read_scene, scene_from_dict, write_scene
from scene.trace import (
    COLUMNS,
    Counters,
    Event,
    Outcome,
    OutcomeKind,
    Profile,
    Trace,
    read_columns,
    write_trace,
)
from scene.watch import Watch

__all__ = [
    "COLUMNS",
    "Adhesion",
    "Branch",
    "BulkRelaxation",
    "Cone",
    "Counters",
    "CreepCompliance",
    "Event",
    "FlatPunch",
    "Force",
    "ForceRamp",
    "Hold",
    "Indenter",
    "Loading",
    "Material",
    "Oscillate",
    "Outcome",
    "OutcomeKind",
    "PowerLaw",
    "Profile",
    "Ramp",
    "Scene",
    "SceneError",
    "Segment",
    "Sphere",
    "Step",
    "Sweep",
    "Table",
    "TabulatedProfile",
    "Trace",
    "UnsupportedScene",
    "Watch",
    "read_columns",
    "read_scene",
    "scene_from_dict",
    "write_scene",
    "write_trace",
]
