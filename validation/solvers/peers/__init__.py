"""Peers: contact codes of others, run as they are, each within what it covers. None is imported here."""

from validation.solvers.peers.adhesion import MaugisRing, SharpEdge
from validation.solvers.peers.hertz_pixels import HertzOnPixels
from validation.solvers.peers.peer import Peer
from validation.solvers.peers.viscoelastic_pixels import ViscoelasticPixels

PEERS: dict[str, Peer] = {
    method.name: method for method in (ViscoelasticPixels(), HertzOnPixels(), SharpEdge(), MaugisRing())
}
"""By name; asked for by name only."""
