"""The quadruped of an example is the one that ``example-robot-data`` ships."""

from dataclasses import replace
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

import examples
from schemas.urdf.reading import read_robot
from schemas.urdf.robot import Joint, Limits, Robot


def shipped() -> Robot:
    found = [one for one in _files() if one.name == "solo12.urdf"]
    if not found:
        pytest.skip("example-robot-data is not installed: pip install '.[dev]'")
    return read_robot(Path(str(found[0].locate())).read_text())


def test_links_and_joints_are_those_of_the_package() -> None:
    theirs = shipped()
    ours = read_robot(examples.load("solo_hop")["phases"][0]["system"]["text"])
    assert list(ours.links) == list(theirs.links)
    for name, link in ours.links.items():
        other = theirs.links[name]
        assert link.mass == other.mass
        assert np.array_equal(link.inertia, other.inertia)
        assert np.array_equal(link.com, other.com)
    assert list(map(_told, ours.joints)) == list(map(_told, theirs.joints))


def _told(joint: Joint) -> Joint:
    """Without its line; what is fixed has no limits."""
    limits = Limits() if joint.kind == "fixed" else joint.limits
    return replace(joint, line=0, limits=limits)


def _files() -> list[metadata.PackagePath]:
    try:
        return metadata.files("example-robot-data") or []
    except metadata.PackageNotFoundError:
        return []
