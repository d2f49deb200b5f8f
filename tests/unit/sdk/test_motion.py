"""How motions are drawn: bodies as paths, frames over one another, the data of the animation."""

import json
import math
import re
import xml.etree.ElementTree as ET
from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

from footfall.report import render, render_motion, render_svg
from footfall.report.animation import motion_data
from footfall.report.looks import pieces, typical_length
from footfall.report.motion import Motion, motion_of
from footfall.report.strobe import FRAMES, fitted, spring, strobe
from tests.support.motions import rolling, throw

EVIL = "</script><script>alert(1)</script>"


def moving(**changes: Any) -> Motion:
    motion = motion_of(throw(rolling() | changes))
    assert motion is not None
    return motion


def rod(**look: Any) -> dict[str, Any]:
    """The scene of one body that looks as given."""
    body = {"outline": [], "places": [], "com": None} | look
    kinds = ("joints", "contacts", "shapes", "springs", "surfaces")
    empty: dict[str, Any] = {kind: {} for kind in kinds}
    return {"bodies": {"b": body}, **empty}


def bodies(scene: dict[str, Any]) -> list[str]:
    return [piece.path for piece in pieces(scene) if piece.kind == "body"]


def numbers(path: str) -> list[float]:
    return [float(text) for text in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", path)]


class TestLooks:
    def test_an_outline_is_drawn_as_it_is(self) -> None:
        (path,) = bodies(rod(outline=[[0, 0], [1, 0], [0, 2]], places=[[0, 0], [5, 5]]))
        assert path == "M0 0L1 0L0 2Z"

    def test_a_frame_without_mass_is_not_seen(self) -> None:
        assert bodies(rod(places=[[0, 0]], com=None)) == []
        assert len(bodies(rod(places=[[0, 0]], com=[0, 0]))) == 1

    def test_an_outline_of_two_points_is_a_rod(self) -> None:
        (path,) = bodies(rod(outline=[[0, 0], [0, 1]], places=[[0, 0], [5, 5]]))
        assert path.count("A") == 2

    def test_without_one_a_body_is_a_rod_from_its_joint_to_each_place(self) -> None:
        paths = bodies(rod(places=[[0, 0], [1, 0], [0, 1]], com=[0.5, 0]))
        assert len(paths) == 2
        for path, (x, y) in zip(paths, [(1, 0), (0, 1)], strict=True):
            ends = np.reshape(numbers(path.split("A")[0]), (2, 2))
            middle = ends - ends[0]
            assert middle[1] == pytest.approx([x, y])

    def test_a_com_off_the_rods_gets_one_of_its_own(self) -> None:
        assert len(bodies(rod(places=[[0, 0], [1, 0]], com=[0.5, 0]))) == 1
        assert len(bodies(rod(places=[[0, 0], [1, 0]], com=[0.5, 0.5]))) == 2
        assert len(bodies(rod(places=[[0, 0]], com=[0, -1]))) == 1

    def test_a_body_without_extent_is_a_disc_and_on_a_slider_a_block(self) -> None:
        scene = rod(places=[[0, 0]], com=[0, 0])
        (disc,) = bodies(scene)
        assert "A" in disc
        slider = {"kind": "prismatic", "body": "ground", "child": "b", "at": [0, 0], "end": [1, 0]}
        (block,) = bodies(scene | {"joints": {"x": slider}})
        assert "A" not in block
        assert [p.kind for p in pieces(scene | {"joints": {"x": slider}})].count("rail") == 1

    def test_a_mere_frame_is_not_drawn(self) -> None:
        assert bodies(rod(places=[[0, 0]])) == []

    def test_contacts_are_wheels_or_dots(self) -> None:
        spot = {"body": "b", "at": [0, 0], "radius": 0.5}
        (wheel,) = bodies(rod(com=[0, 0], places=[[0, 0]]) | {"contacts": {"c": spot}})
        assert numbers(wheel)[:2] == [0.5, 0]
        assert typical_length(rod() | {"contacts": {"c": spot}}) == 1.0
        scene = rod(places=[[0, 0], [1, 0]]) | {"contacts": {"c": spot | {"radius": 0}}}
        assert "ink" in [piece.kind for piece in pieces(scene)]

    def test_shapes_are_ellipses(self) -> None:
        shape = {"body": "b", "at": [1, 2], "axes": [3, 4]}
        (path,) = bodies(rod() | {"shapes": {"s": shape}})
        assert path.startswith("M4 2A3 4 ")


class TestMotion:
    def test_a_result_without_frames_has_none(self) -> None:
        assert motion_of(throw()) is None
        assert render_motion(throw()) is None

    def test_places_turn_with_their_body(self) -> None:
        (clip,) = moving().clips
        tip = clip.place("rod", [0, 0.5])
        share = clip.time / 1.5
        turn = 2 * math.pi * share
        assert tip[:, 0] == pytest.approx(share - 0.5 * np.sin(turn))
        assert tip[:, 1] == pytest.approx(0.5 * np.cos(turn))

    def test_all_that_moves_is_in_view(self) -> None:
        motion = moving()
        view = motion.view
        assert view.left < -0.25 < 1.25 < view.right
        assert view.low < -0.5 < 0.5 < view.high
        assert view.width < 2
        wide = fitted(view)
        assert wide.left <= view.left
        assert wide.high >= view.high
        assert 0.2 <= wide.height / wide.width <= 0.62 + 1e-12

    def test_both_ends_of_a_spring_are_in_view(self) -> None:
        far = [{"body": "ground", "at": [0, 4]}, {"body": "rod", "at": [0, 0]}]
        given = throw(rolling())
        given["phases"][0]["frames"]["scene"]["springs"] = {"far": far}
        motion = motion_of(given)
        assert motion is not None
        assert motion.view.high > 4
        assert moving().view.high < 4

    def test_who_travels_far_is_followed(self) -> None:
        assert moving().follow is None
        frames = rolling()
        for body in frames["bodies"].values():
            body["x"] = [100 * x for x in body["x"]]
        motion = moving(bodies=frames["bodies"])
        assert motion.follow == pytest.approx(8 * motion.size)

    def test_frames_without_numbers_are_left_out(self) -> None:
        frames = rolling()
        frames["bodies"]["cart"]["x"][-1] = None
        (clip,) = moving(bodies=frames["bodies"]).clips
        assert len(clip.time) == 30
        assert "NaN" not in json.dumps(motion_data(moving(bodies=frames["bodies"])))

    def test_the_largest_usual_force_has_a_length_that_fits(self) -> None:
        motion = moving()
        longest = 10 * motion.newton
        assert 0.1 * motion.view.height < longest < 0.4 * motion.view.height

    def test_a_blow_is_cut_and_hides_no_other_force(self) -> None:
        frames = rolling()
        (push,) = frames["forces"].values()
        count = len(frames["time"])
        push |= {"fx": [0.0] * count, "fy": [5e3, *[10.0] * 21, *[1e-6] * (count - 22)]}
        motion = moving(forces=frames["forces"])
        usual = 10 * motion.newton
        assert 0.1 * motion.view.height < usual < 0.4 * motion.view.height
        (rows,) = motion.clips[0].forces.values()
        assert rows[0, 3] == pytest.approx(40.0)
        assert motion.cut
        assert not moving().cut


class TestSpace:
    """A rod of 1 m that turns once about y, at y = 0.5."""

    def motion(self) -> Motion:
        turns = [index / 20 for index in range(21)]
        still, half = [0.0] * 21, [math.pi * share for share in turns]
        rod = {
            "x": still,
            "y": [0.5] * 21,
            "z": still,
            "quaternion": [[math.cos(a), 0.0, math.sin(a), 0.0] for a in half],
        }
        scene = {
            "bodies": {"rod": {"places": [[0, 0, 0], [0, 0, 1]], "com": [0, 0, 0.5]}},
            "surfaces": {"ground": [[-1, 0, -1], [1, 0, -1]]},
        }
        push = {"x": still, "y": [0.5] * 21, "z": still, "fx": still, "fy": [2.0] * 21}
        forces = {"foot": push | {"fz": [10.0] * 21}}
        frames = {"time": turns, "bodies": {"rod": rod}, "scene": scene, "forces": forces}
        found = motion_of(throw(frames))
        assert found is not None
        return found

    def test_x_and_z_are_seen_in_their_true_length(self) -> None:
        (clip,) = self.motion().clips
        ((_, rows),) = clip.sticks
        angle = 2 * math.pi * clip.time
        start, along = rows[:, :2], rows[:, 2:] - rows[:, :2]
        assert start == pytest.approx(np.tile([0.2, 0.1], (21, 1)))
        assert along == pytest.approx(np.column_stack([np.sin(angle), np.cos(angle)]))

    def test_forces_are_seen_as_places_are(self) -> None:
        (clip,) = self.motion().clips
        assert clip.forces["foot"] == pytest.approx(np.tile([0.2, 0.1, 0.8, 10.4], (21, 1)))
        assert strobe(self.motion(), 900.0)[0].count('class="force"') == FRAMES

    def test_level_ground_stays_level(self) -> None:
        (clip,) = self.motion().clips
        assert np.ptp(clip.surfaces[0][:, 1]) == 0

    def test_it_is_in_view_and_drawn(self) -> None:
        view = self.motion().view
        assert view.left < -0.8
        assert view.high > 1.1
        picture = strobe(self.motion(), 900.0)[0]
        assert picture.count('class="stick s0"') == FRAMES
        assert len(motion_data(self.motion())["clips"][0]["sticks"]) == 1


class TestStrobe:
    def picture(self, **changes: Any) -> ET.Element:
        drawn = render_motion(throw(rolling() | changes, name=EVIL))
        assert drawn is not None
        return ET.fromstring(drawn)  # noqa: S314 - our own text

    def of(self, kind: str, picture: ET.Element) -> list[ET.Element]:
        return [one for one in picture.iter() if kind in (one.get("class") or "").split()]

    def test_it_has_frames_ground_traces_springs_and_forces(self) -> None:
        picture = self.picture()
        shots = self.of("shot", picture)
        assert len(shots) == FRAMES
        shades = [float(shot.get("opacity") or 0) for shot in shots]
        assert shades == sorted(shades)
        assert shades[-1] == 1
        assert len(self.of("surface", picture)) == 1
        assert len(self.of("trace", picture)) == 2
        assert len(self.of("spring", picture)) == FRAMES
        arrows = [len(self.of("force", one)) for one in self.of("pushes", picture)]
        assert arrows == [0, *[1] * (FRAMES - 1)]  # there is none at the start
        assert len(self.of("com", picture)) == 2

    def test_a_kick_between_two_frames_is_seen(self) -> None:
        frames = rolling()
        (push,) = frames["forces"].values()
        kick = [10.0 if index == 5 else 0.0 for index in range(len(frames["time"]))]
        push |= {"fx": [0.0] * len(kick), "fy": kick}
        picture = self.picture(forces=frames["forces"])
        assert sum(len(self.of("force", one)) for one in self.of("pushes", picture)) == 1
        assert len(self.of("shot", picture)) == FRAMES

    def test_a_frame_stands_where_the_bodies_are(self) -> None:
        shot = self.of("shot", self.picture())[(FRAMES - 1) // 2]
        turned = [p.get("transform") for p in shot if p.get("class") == "body s1"]
        assert turned == ["translate(0.5 0) rotate(180)"]

    def test_the_name_is_text(self) -> None:
        drawn = render_motion(throw(rolling(), name=EVIL)) or ""
        assert EVIL not in drawn

    def test_a_spring_goes_from_end_to_end(self) -> None:
        points = np.reshape(
            numbers(spring(np.array([0.0, 0.0]), np.array([2.0, 0.0]), 0.1)), (-1, 2)
        )
        assert points[0].tolist() == [0, 0]
        assert points[-1].tolist() == [2, 0]
        assert np.abs(points[:, 1]).max() == pytest.approx(0.1)


class Scripts(HTMLParser):
    """The scripts of a page, by their order."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[tuple[dict[str, str | None], str]] = []
        self._open = False
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._open = tag == "script"
        if self._open:
            self.found.append((dict(attrs), ""))

    def handle_data(self, data: str) -> None:
        if self._open:
            attributes, text = self.found[-1]
            self.found[-1] = (attributes, text + data)

    def handle_endtag(self, tag: str) -> None:
        self._open = False


class TestPage:
    def test_the_page_of_a_simulation_says_what_happened(self) -> None:
        impact = {"time": 0.5, "kind": "impact", "name": "wheel", "normal": 1.25,
                  "tangential": -0.5, "gap_rate": [-1, 0.5]}  # fmt: skip
        modes = {
            "contacts": ["wheel"],
            "modes": [{"start": 0, "end": 1.5, "contacts": {"wheel": "sliding_right"}}],
            "distinct": 1,
            "possible": 4,
        }
        energy = {"initial": 1.0, "final": 0.5, "drift": 0.25}
        page = render(
            throw(rolling(), events=[impact], mode_sequence=modes, energy=energy),
            {"name": "throw"},
        )
        for words in ("Footfall simulation", "finished", "impact", "1.25", "sliding right",
                      "1 distinct mode of 4", "drift 0.25", "footfall simulate"):  # fmt: skip
            assert words in page.replace("\N{MINUS SIGN}", "-")

    def test_the_motion_is_in_the_page_only_where_there_is_one(self) -> None:
        assert "player" not in Scripts(render(throw())).found[-1][1]
        assert len(Scripts(render(throw())).found) == 2
        assert len(Scripts(render(throw(rolling()))).found) == 4

    def test_every_script_is_allowed_by_its_hash_alone(self) -> None:
        page = render(throw(rolling()))
        (policy,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]+)"', page)
        run = [text for attributes, text in Scripts(page).found if "type" not in attributes]
        hashes = [b64encode(sha256(text.encode()).digest()).decode() for text in run]
        allowed = policy.replace("&#x27;", "'").split("script-src ")[1].split(";")[0]
        assert allowed.split() == [f"'sha256-{one}'" for one in hashes]
        assert "unsafe" not in policy

    @pytest.mark.parametrize(("end", "speed"), [(0.01, "0.1"), (0.4, "0.25"), (2, "1"), (90, "1")])
    def test_a_brief_motion_is_played_slowly(self, end: float, speed: str) -> None:
        frames = rolling()
        frames["time"] = [end * index / 30 for index in range(31)]
        assert re.findall(r'value="([\d.]+)" selected=""', render(throw(frames))) == [speed]

    def test_names_of_users_stay_data(self) -> None:
        frames = rolling()
        frames["bodies"][EVIL] = frames["bodies"]["rod"]
        frames["scene"]["bodies"][EVIL] = frames["scene"]["bodies"]["rod"]
        page = render(throw(frames, name=EVIL))
        assert EVIL not in page
        data = next(text for at, text in Scripts(page).found if at.get("id") == "motion")
        assert EVIL in json.loads(data)["clips"][0]["poses"]

    def test_its_curves_make_a_picture_too(self) -> None:
        assert "mesh errors" not in render_svg(throw(rolling()))
        assert "throw" in render_svg(throw())
