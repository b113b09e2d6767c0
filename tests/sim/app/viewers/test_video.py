"""Videos of episodes: complete, readable, and without influence on the results."""

from __future__ import annotations

import itertools
import json
import resource
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import av.error
import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sim.app.commands.run import entry
from sim.app.composition.perception import AskedSegmenter
from sim.app.composition.segmenters import make_segmenter
from sim.app.evaluation.rollout import play_episode
from sim.app.options import RunOptions
from sim.app.viewers import overlay, video
from sim.app.viewers.chase import SECTION, ChaseView, hidden_obstacles
from sim.app.viewers.topview import BLOCKED, FREE, INSTANCE, OBSTACLE, SHORTEST, SUCCEEDS, TopView, whole_storey_m
from sim.app.viewers.video import FRAMES_PER_S, VideoRecorder, VideoWriter, video_file
from sim.app.viewers.viewer import VIEWER_IMAGES, Moment
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40, MPCAT40_ID, Action, CameraModel, ConfigError, Scores, SuccessRule
from sim.core.option_types import meanings
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.gl import mujoco
from sim.houses.labels import geoms_of
from sim.robot.body import PREFIX
from sim.task.explanations import Outcome, explain_end
from sim.task.ground_truth import GroundTruth
from sim.world.world import World
from stubborn.drawing.map_painter import AgentMapPainter
from tests.helpers import browser
from tests.helpers.results import a_result, lines_of
from tests.helpers.runners import Script
from tests.helpers.worlds import room, sofa_room, with_box

WHOLE_END_FRAMES = video.END_FRAMES
EPISODE = Episode("sofa room/0", "sofa_room", "sofa", Pose(-1.0, 0.0, 0.0))
AHEAD = [Action.MOVE_FORWARD] * 3


@pytest.fixture
def env(house: Path) -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(house=house, sensors=(), truth=VIEWER_IMAGES, camera=CameraModel(width_px=64, height_px=48))
    yield env
    env.close()


@pytest.fixture(autouse=True)
def short_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """Uses a short end of the video in this process, because encoding takes most of the time."""
    monkeypatch.setattr(video, "END_FRAMES", 2)


def frames_of(file: Path) -> list[NDArray[np.uint8]]:
    capture = cv2.VideoCapture(str(file))
    frames = []
    while (read := capture.read())[0]:
        frames.append(np.asarray(read[1], np.uint8))
    return frames


@pytest.mark.costly
def test_filming_changes_no_result_line_with_noise_of_any_sensor(house: Path, tmp_path: Path) -> None:
    options = ["--semantics", "gt", "--house", str(house), "--noise", "realsense", "--episodes", "1", "--out"]
    assert entry([*options, str(tmp_path / "plain")]) == 0
    assert entry([*options, str(tmp_path / "filmed"), "--video"]) == 0
    assert lines_of(tmp_path / "plain") == lines_of(tmp_path / "filmed")
    (line,) = lines_of(tmp_path / "filmed")
    assert line["num_steps"] > 5
    assert len(frames_of(video_file(tmp_path / "filmed", line["episode_id"]))) == line["num_steps"] + video.END_FRAMES


@pytest.mark.slow
def test_a_run_resumed_with_two_workers_records_the_remaining_episodes(house: Path, tmp_path: Path) -> None:
    options = ["--agent", "tests.helpers.runners:make_quitter", "--house", str(house), "--out", str(tmp_path)]
    assert entry([*options, "--episodes", "1"]) == 0
    assert not (tmp_path / "videos").exists()
    assert entry([*options, "--episodes", "3", "--video", "--workers", "2"]) == 0
    first, *others = lines_of(tmp_path)
    filmed = {video_file(tmp_path, line["episode_id"]) for line in others}
    assert set((tmp_path / "videos").iterdir()) == filmed
    assert all(len(frames_of(file)) == 1 + WHOLE_END_FRAMES for file in filmed)
    assert first["episode_id"] not in {line["episode_id"] for line in others}
    viewers = {name for name, option in meanings(RunOptions).items() if option.viewer}
    assert viewers <= set(json.loads((tmp_path / "config.json").read_text()))


def test_a_video_is_h264_in_an_mp4_of_1280_pixels_and_its_name_holds_any_episode(
    env: ObjectNavEnv, tmp_path: Path
) -> None:
    play_episode(env, Script([*AHEAD, Action.STOP]), EPISODE, seed=0, viewers=[VideoRecorder(tmp_path)])
    (file,) = (tmp_path / "videos").iterdir()
    assert file == video_file(tmp_path, EPISODE.episode_id)
    assert file.name == "sofa room%2F0.mp4"
    content = file.read_bytes()
    assert content[4:8] == b"ftyp"
    assert b"avc1" in content
    assert content.index(b"moov") < content.index(b"mdat")  # plays before all of it is loaded
    frames = frames_of(file)
    assert {frame.shape for frame in frames} == {(720, 1280, 3)}
    stop, outcome = (frames[i][: overlay.HEIGHT_PX // 15, 600:].astype(int) for i in (-video.END_FRAMES - 1, -1))
    assert np.abs(stop - outcome).mean() > 3.0  # the outcome is shown in place of the step


@pytest.mark.costly
def test_a_video_plays_in_a_browser_to_its_end_and_can_be_searched(env: ObjectNavEnv, tmp_path: Path) -> None:
    if browser.missing():
        pytest.skip(str(browser.missing()))
    play_episode(env, Script([*AHEAD, Action.STOP]), EPISODE, seed=0, viewers=[VideoRecorder(tmp_path)])
    page = tmp_path / "page.html"
    page.write_text("<video muted src='videos/sofa room%252F0.mp4'></video>")
    window = browser.Browser(tmp_path / "profile")
    try:
        window.open(page)
        seen = window.run("""
            const video = document.querySelector("video");
            const wait = (event) => new Promise((done, fail) => {
                video.addEventListener(event, done, {once: true});
                video.addEventListener("error", () => fail(video.error.message), {once: true});
            });
            return (async () => {
                if (video.readyState < 3) await wait("canplay");
                video.currentTime = 1.0;
                await wait("seeked");
                video.playbackRate = 4;
                const ended = wait("ended");
                await video.play();
                await ended;
                return [video.videoWidth, video.videoHeight, video.duration];
            })();
        """)
    finally:
        window.close()
    assert seen == [1280, 720, pytest.approx((4 + video.END_FRAMES) / FRAMES_PER_S, abs=0.05)]


def test_an_episode_that_breaks_leaves_its_video_too(env: ObjectNavEnv, tmp_path: Path) -> None:
    def break_it(step: int) -> None:
        if step == 2:
            env.scene.world.data.qvel[:] = np.nan

    line = play_episode(env, Script(AHEAD, break_it), EPISODE, seed=0, viewers=[VideoRecorder(tmp_path)])
    assert line.end_reason == "error"
    assert len(frames_of(video_file(tmp_path, EPISODE.episode_id))) == 2 + video.END_FRAMES


def test_an_episode_that_is_not_ended_leaves_nothing(env: ObjectNavEnv, tmp_path: Path) -> None:
    def interrupt(step: int) -> None:
        if step == 1:
            raise KeyboardInterrupt

    recorder = VideoRecorder(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        play_episode(env, Script(AHEAD, interrupt), EPISODE, seed=0, viewers=[recorder])
    recorder.close()
    assert list((tmp_path / "videos").iterdir()) == []


Box = tuple[int, int, int, int]


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, Box]]:
    """Records every text that is written into a frame, and its position."""
    boxes: list[tuple[str, Box]] = []
    real = cv2.putText

    def put(image, words, org, colour, font, size, weight):
        left, top, width, height = cv2.getTextSize((4096, 4096), words, org, font, size, weight)
        if image.shape[1] == overlay.WIDTH_PX:
            boxes.append((words, (left, top + 1, left + width, top + height - 1)))
        return real(image, words, org, colour, font, size, weight)

    monkeypatch.setattr(cv2, "putText", put)
    return boxes


def crowded_moment() -> Moment:
    """Returns a moment with all categories in view."""
    semantic = np.repeat(np.arange(len(MPCAT40), dtype=np.uint8), 20)[None].repeat(615, axis=0)
    images = {
        "semantic": semantic,
        "rgb": np.zeros((*semantic.shape, 3), np.uint8),
        "depth": np.full(semantic.shape, 2.0, np.float32),
    }
    return Moment(step=500, observation={}, images=images, action=Action.TURN_RIGHT)


def perceived_in(moment: Moment) -> overlay.Perceived:
    target = np.full((48, 64), 0.25, np.float32)
    return overlay.Perceived(scores=Scores(target, 1 - target), categories=moment.images["semantic"])


PLAN = np.zeros((overlay.MAP_PX, overlay.MAP_PX, 3), np.uint8)
WIDE_PLAN = np.zeros((overlay.MAP_PX, 616, 3), np.uint8)
INFO = {"collided": True, "distance_to_goal": 123.4, "collisions": 499, "path_length": 123.4}


@pytest.mark.parametrize("goal", ["bed", "chest_of_drawers", "gym_equipment"])
def test_no_text_leaves_the_frame_or_lies_on_another(goal: str, written: list[tuple[str, Box]]) -> None:
    state = "goes to a candidate, and says so in a sentence that nobody has shortened for the video"
    panel = overlay.MapPanel(image=PLAN, words=state)
    composer = overlay.FrameComposer(
        goal,
        CameraModel(),
        plan_legend=TopView.legend,
        map_legend=AgentMapPainter.legend,
        scores=True,
        names=True,
        max_steps=1000,
    )
    moment = crowded_moment()
    frame = composer.compose(moment, plan=PLAN, map_panel=panel, perceived=perceived_in(moment))
    composer.add_outcome(frame, {**INFO, "episode_id": "an_episode_with_a_long_name_0123456789"})
    assert goal.replace("_", " ") in [text for text, _ in written]
    for i, (text, (left, top, right, bottom)) in enumerate(written):
        assert min(left, top) >= 0, text
        assert right <= overlay.WIDTH_PX, text
        assert bottom <= overlay.HEIGHT_PX, text
        for other, (left2, top2, right2, bottom2) in written[:i]:
            assert right <= left2 or right2 <= left or bottom <= top2 or bottom2 <= top, (text, other)
    written.clear()
    composer.add_end(frame, Outcome(False, "Not found after 1000 steps", "A position is not finite. " * 20))
    assert all(right <= overlay.WIDTH_PX and bottom <= 540 for _, (_, _, right, bottom) in written)


def test_the_goals_of_a_chain_are_ticked_off(written: list[tuple[str, Box]]) -> None:
    marks = [
        overlay.GoalMark("sofa", True),
        overlay.GoalMark("desk", False),
        overlay.GoalMark("bed", None, present=True),
    ]
    composer, moment = overlay.FrameComposer("bed", CameraModel(), plan_legend=()), crowded_moment()
    without = composer.compose(moment, plan=WIDE_PLAN)
    written.clear()
    frame = composer.compose(moment, plan=WIDE_PLAN, goals=[*marks, overlay.GoalMark("chair", None)])
    assert [text for text, _ in written][:4] == ["1  sofa", "2  desk", "3  bed", "4  chair"]
    rows = [(frame != without)[72 + 20 * row : 88 + 20 * row, 20:36] for row in range(4)]
    colours = [frame[72 + 20 * row : 88 + 20 * row, 20:36].reshape(-1, 3) for row in range(4)]
    assert all(row.any() for row in rows)
    for row, colour in enumerate([overlay.FOUND, overlay.MISSED, overlay.WHITE]):
        assert (colours[row] == colour).all(axis=1).any()
    written.clear()
    composer.compose(moment, plan=WIDE_PLAN, goals=[overlay.GoalMark(f"goal {i}", None, i == 30) for i in range(50)])
    shown = [text for text, _ in written if text.split()[0].isdigit() and "goal" in text]
    assert len(shown) == 12
    assert "31  goal 30" in shown


def test_the_picture_of_a_goal_lies_over_the_camera_picture(written: list[tuple[str, Box]]) -> None:
    orange = np.full((512, 512, 3), (250, 130, 10), np.uint8)
    composer = overlay.FrameComposer("chair_00", CameraModel(), plan_legend=(), picture=orange)
    assert "Looking for the object in the picture" in [text for text, _ in written]
    frame = composer.compose(crowded_moment(), plan=WIDE_PLAN)
    rows, cols = np.nonzero((frame == (250, 130, 10)).all(axis=2))
    assert np.ptp(rows) == np.ptp(cols) > 100
    assert cols.max() < 648
    assert rows.max() < 300


@pytest.mark.parametrize(("name", "captions"), [
    ("ground truth", ["segmentation (ground truth)"]),
    ("rednet", ["segmentation (rednet)", "segmentation (true)"]),
])  # fmt: skip
def test_a_true_segmentation_is_shown_once(name: str, captions: list[str], written: list[tuple[str, Box]]) -> None:
    overlay.FrameComposer("bed", CameraModel(), plan_legend=(), scores=True, names=True, segmentation=name)
    assert [text for text, _ in written if text.startswith("segmentation")] == captions


@pytest.mark.parametrize("shape", [(360, 640), (480, 480), (64, 48)])
def test_a_camera_of_another_shape_keeps_its_proportions(shape: tuple[int, int]) -> None:
    images = {
        "rgb": np.full((*shape, 3), 9, np.uint8),
        "semantic": np.zeros(shape, np.uint8),
        "depth": np.zeros(shape, np.float32),
    }
    moment = Moment(step=1, observation={}, images=images, action=Action.STOP)
    composer = overlay.FrameComposer("bed", CameraModel(width_px=shape[1], height_px=shape[0]), plan_legend=())
    frame = composer.compose(moment, plan=WIDE_PLAN)
    rows, cols = np.nonzero((frame == 9).all(axis=2))
    assert np.ptp(cols) / np.ptp(rows) == pytest.approx(shape[1] / shape[0], rel=0.02)
    assert np.ptp(cols) + 1 == 640 or np.ptp(rows) + 1 == 480


def test_an_agent_without_a_map_and_a_segmentation_has_a_wide_plan_and_no_empty_panels() -> None:
    composer = overlay.FrameComposer("bed", CameraModel(), plan_legend=TopView.legend)
    assert composer.plan_px == (616, overlay.MAP_PX)
    frame = composer.compose(crowded_moment(), plan=WIDE_PLAN)
    blocks = {tuple(colour) for colour in frame[::8, ::8].reshape(-1, 3).tolist()}
    assert (228, 228, 226) not in blocks
    assert (frame[340:620, 660:1270] == 0).all()


def test_a_colour_of_both_maps_has_one_meaning() -> None:
    plan, agents = ({colour: name for name, colour in of.legend} for of in (TopView, AgentMapPainter))
    assert len(plan) == len(TopView.legend)
    assert len(agents) == len(AgentMapPainter.legend)
    shared = {colour for colour in plan if colour in agents}
    assert {plan[colour] for colour in shared} == {"driven path", "obstacle"}
    assert all(plan[colour] == agents[colour] for colour in shared)
    apart = [np.abs(np.subtract(a, b)).max() for a in plan for b in agents if a not in shared or b not in shared]
    assert min(apart) >= 12


@pytest.mark.parametrize("yaw_rad", [0.0, 0.5, 2.0, -1.2])
def test_the_plan_beside_a_map_has_the_heading_of_the_start_up(env: ObjectNavEnv, yaw_rad: float) -> None:
    env.reset(options={"episode": replace(EPISODE, start=Pose(-1.0, 0.0, yaw_rad))})
    view = TopView(env, heading_up=True)
    view.paint(300)
    here, ahead, left = view.pixels(
        np.array([(-1.0, 0.0), (-1.0 + np.cos(yaw_rad), np.sin(yaw_rad)), (-1.0 - np.sin(yaw_rad), np.cos(yaw_rad))])
    )
    assert abs(ahead[0] - here[0]) <= 1
    assert ahead[1] < here[1] - 20
    assert left[0] < here[0] - 20
    corners = view.pixels(np.array([(x, y) for x in (-3.0, 3.0) for y in (-3.0, 3.0)]))
    assert corners.min() >= 0
    assert corners.max() <= 300


def test_a_collision_puts_a_red_frame_around_the_camera_picture() -> None:
    moment = crowded_moment()
    composer = overlay.FrameComposer("bed", CameraModel(), plan_legend=())
    calm, hit = (composer.compose(moment, plan=WIDE_PLAN) for _ in range(2))
    composer.add_outcome(calm, {**INFO, "collided": False, "episode_id": "e"})
    composer.add_outcome(hit, {**INFO, "episode_id": "e"})
    assert tuple(hit[300, 9]) == overlay.ALARM
    assert tuple(calm[300, 9]) == (0, 0, 0)


def test_the_score_of_the_goal_is_bright_where_it_is_high_and_grey_where_it_is_zero() -> None:
    target = np.zeros((48, 64), np.float32)
    target[:, 32:] = 1.0
    picture = overlay.score_picture(np.full((96, 128, 3), 100, np.uint8), target).astype(int)
    assert tuple(picture[50, 10]) == (50, 50, 50)
    assert picture[50, 120].sum() > 500


def test_a_legend_without_room_for_all_names_has_those_of_the_largest_areas() -> None:
    wall, bed, shelving, misc = (MPCAT40_ID[name] for name in ("wall", "bed", "shelving", "misc"))
    semantic = np.full((10, 100), misc, np.uint8)
    semantic[:, :10], semantic[:, 10:30], semantic[:, 30:31] = wall, shelving, bed
    assert overlay.names_in_sight(semantic, "bed", 3) == [bed, shelving, misc]
    assert len(overlay.names_in_sight(semantic, "bed")) == 4


def test_what_the_near_plane_cuts_through_is_a_solid_section(env: ObjectNavEnv) -> None:
    env.reset(options={"episode": replace(EPISODE, start=Pose(-2.7, 0.0, 0.0))})
    view = ChaseView(env.scene, width_px=200, height_px=120)
    picture = view.render()
    view.close()
    assert (picture == SECTION).all(axis=-1).mean() > 0.01  # the wall at x = -3 m


def test_the_robot_stands_in_the_middle_of_the_chase_view_and_a_wall_behind_it_does_not_hide_it(
    env: ObjectNavEnv,
) -> None:
    def share_of_robot(x_m: float) -> float:
        env.reset(options={"episode": replace(EPISODE, start=Pose(x_m, 0.0, 0.0))})
        model = env.scene.world.model
        model.geom_rgba[geoms_of(model, PREFIX)] = (1.0, 0.0, 0.0, 1.0)
        view = ChaseView(env.scene, width_px=200, height_px=120)
        picture = view.render()[30:90, 92:108].astype(int)
        view.close()
        return float((picture[..., 0] > 3 * picture[..., 1]).mean())

    in_the_open, before_a_wall = share_of_robot(0.0), share_of_robot(-2.7)
    assert in_the_open > 0.4
    assert before_a_wall > 0.4  # without the cut, the wall at x = -3 m would cover it


def test_the_arrow_on_the_robot_leans_with_its_body(env: ObjectNavEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    env.reset(options={"episode": replace(EPISODE, start=Pose(0.0, 0.0, 0.0))})
    view, world = ChaseView(env.scene, width_px=200, height_px=120), env.scene.world

    def row_of_arrow(pitch_rad: float) -> float:
        leaning = replace(upright, pitch_rad=pitch_rad)
        monkeypatch.setattr(type(world), "body_pose", property(lambda _: leaning))
        picture = view.render().astype(int)
        return float(np.nonzero(picture[..., 2] > 2 * picture[..., 0] + 10)[0].mean())

    upright = world.body_pose
    assert row_of_arrow(0.2) < row_of_arrow(0.0) < row_of_arrow(-0.2)
    view.close()


def test_a_finer_chase_view_has_the_same_size_and_smoother_edges(env: ObjectNavEnv) -> None:
    env.reset(options={"episode": replace(EPISODE, start=Pose(0.0, 0.0, 0.3))})
    rough, fine = (ChaseView(env.scene, width_px=200, height_px=120, finer=finer) for finer in (1, 2))
    pictures = [view.render().astype(int) for view in (rough, fine)]
    rough.close()
    fine.close()
    steps = [np.abs(np.diff(picture, axis=1)).max(axis=-1) for picture in pictures]
    assert pictures[0].shape == pictures[1].shape == (120, 200, 3)
    assert np.abs(pictures[0] - pictures[1]).mean() < 10
    assert np.quantile(steps[1], 0.99) < np.quantile(steps[0], 0.99)


def test_an_observed_image_is_shown_and_the_true_one_if_it_was_not_observed() -> None:
    truth = {"rgb": np.zeros((2, 2, 3), np.uint8), "depth": np.ones((2, 2), np.float32)}
    noisy = np.full((2, 2), 2.0, np.float32)
    moment = Moment(step=1, observation={"depth": noisy}, images=truth, action=Action.STOP)
    assert moment.seen("depth") is noisy
    assert moment.seen("rgb") is truth["rgb"]


def test_no_return_is_black_and_near_is_brighter_than_far() -> None:
    camera = CameraModel()
    near, far, nothing = overlay.colour_depth(np.array([[0.5, 5.0, 0.0]], np.float32), camera)[0].astype(int)
    assert nothing.sum() == 0
    assert near.sum() > far.sum() > 0


def test_the_floor_plan_shows_goal_robot_path_and_the_free_space_of_the_task(env: ObjectNavEnv) -> None:
    env.reset(options={"episode": EPISODE})
    view = TopView(env)
    before = view.paint(300)
    colours = {tuple(colour) for colour in before.reshape(-1, 3).tolist()}
    assert {FREE, BLOCKED, OBSTACLE, INSTANCE, SUCCEEDS, SHORTEST} <= colours
    for _ in range(4):
        env.step(Action.MOVE_FORWARD)
    assert (32, 84, 190) in {tuple(colour) for colour in view.paint(300).reshape(-1, 3).tolist()}
    sofa = np.argwhere((before == (56, 158, 80)).all(axis=2)).mean(axis=0)
    assert sofa[1] > 200  # in the east, which is on the right
    assert sofa[0] == pytest.approx(150, abs=8)


def test_the_shortest_path_is_shown_where_the_floor_is_not_exactly_at_zero(tmp_path: Path) -> None:
    house = sofa_room()
    house.spec.geom("floor_00").pos[2] = 0.005
    (tmp_path / "high.xml").write_text(house.spec.to_xml())
    env = ObjectNavEnv(house=tmp_path / "high.xml", goal="sofa", start=Pose(-1.0, 0.5, 0.0), sensors=())
    env.reset(seed=0)
    assert SHORTEST in {tuple(colour) for colour in TopView(env).paint(300).reshape(-1, 3).tolist()}
    env.close()


@pytest.mark.parametrize("east_m", [10.0, 20.0])
def test_the_plan_shows_the_whole_house_and_a_goal_behind_furniture(east_m: float) -> None:
    furnished = with_box(room(east_m, 4), "cabinet_00", centre_m=(east_m / 2 - 0.5, 0, 0.9), half_m=(0.5, 2.0, 0.9))
    house = with_box(furnished, "sofa_00", centre_m=(east_m / 2 - 0.1, 0, 2.0), half_m=(0.1, 0.8, 0.2))
    truth = GroundTruth(World(house))
    space, target = truth.space(), truth.target("sofa")
    low, high = (edge(whole_storey_m(space, target), axis=0) for edge in (np.min, np.max))
    assert np.all(low <= (-east_m / 2, -2.0))
    assert np.all(high >= (east_m / 2, 2.0))


def test_a_video_that_the_disk_cannot_hold_is_an_error_and_no_file(tmp_path: Path) -> None:
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    frames = np.random.default_rng(0).integers(0, 256, (3, 96, 128, 3), np.uint8)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2_000, limit[1]))  # larger files cannot be written
    try:
        writer = VideoWriter(tmp_path / "a.mp4", size_px=(128, 96))
        for frame in frames:
            writer.write(frame)
        with pytest.raises(ConfigError, match=r"a\.mp4.*films"):
            writer.finish()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("failure", [av.error.ExternalError(1, "It broke"), MemoryError(), av.error.BugError(2, "A")])
def test_each_error_of_the_encoder_is_reported_and_leaves_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: Exception
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise failure

    monkeypatch.setattr(video.av, "VideoFrame", SimpleNamespace(from_ndarray=fail))
    writer = VideoWriter(tmp_path / "a.mp4", size_px=(128, 96))
    for _ in range(3 * video._WAITING_FRAMES):  # more than can wait
        writer.write(np.zeros((96, 128, 3), np.uint8))
    with pytest.raises(ConfigError, match=r"a\.mp4.*\S.*films"):
        writer.finish()
    assert list(tmp_path.iterdir()) == []


WRONG, SHORT = ({"end_reason": "stop", "failure": cause} for cause in ("false_detection", "stopped_short"))
BESIDE, OUT_OF_STEPS = {"end_reason": "stop", "failure": "misc"}, {"end_reason": "max_steps"}
FOR_ANOTHER = WRONG | {"stop_target_to_goal_m": 1.84}
ENDS = [
    ({"success": 1.0, "end_reason": "stop"}, 0.72, "The STOP counts: the nearest chair is 0.72 m away"),
    (WRONG, 4.2, "False detection: the agent took another"),
    (WRONG | {"detects": False}, 4.2, "The STOP came too early: the nearest chair"),
    (FOR_ANOTHER, 0.8, "False detection: the agent stopped for something 1.8 m from the nearest chair."),
    (
        FOR_ANOTHER | {"stop_target_category": "sofa"}, 4.2,
        "False detection: the agent stopped at a sofa, 1.8 m from the nearest chair.",
    ),
    (SHORT | {"stop_target_to_goal_m": 0.04}, 1.3, "The STOP came too early: the nearest chair is 1.30 m"),
    (BESIDE, 1.003, "the nearest chair is 1.01 m away. At most 1 m counts."),
    (BESIDE, 0.8, "but a wall or a door hides it"),
    (WRONG, None, "there is no chair on this storey"),
    (OUT_OF_STEPS | {"failure": "explore"}, 3.0, "used up. The goal never covered 0.8 % of an image."),
    (
        OUT_OF_STEPS | {"failure": "trapped"}, 3.0,
        "All 9 steps are used up. The robot was trapped: 100 steps within 1 m of one position.",
    ),
    (
        OUT_OF_STEPS | {"failure": "misc", "distance_to_goal": 0.0}, 0.5,
        "The robot is where a STOP counts, and STOP was not called.",
    ),
    ({"end_reason": "fallen", "failure": "stairs"}, 3.0, "drove over an edge"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "nearest_m", "expected"), ENDS)
def test_the_explanation_of_the_end_names_its_cause(line: dict, nearest_m: float | None, expected: str) -> None:
    fixed = {"success": 0.0, "spl": 0.5, "num_steps": 9, "path_length": 3.0, "shortest_path": 2.0}
    detects = line.get("detects", True)
    known = {name: value for name, value in line.items() if name != "detects"}
    whole = a_result(**fixed | {"distance_to_goal": None} | known)
    outcome = explain_end(whole, "chair", SuccessRule(), nearest_m, detects=detects)
    assert expected in outcome.sentence
    assert outcome.found == bool(whole.success)


@pytest.mark.parametrize(
    ("line", "nearest_m", "expected"),
    [
        ({"success": 1.0, "end_reason": "stop"}, 0.72, "The STOP counts: the nearest clothes are 0.72 m away"),
        (BESIDE, 0.8, "the nearest clothes are 0.80 m away, but a wall or a door hides them."),
        (WRONG, None, "there are no clothes on this storey"),
        (
            FOR_ANOTHER | {"stop_target_category": "appliances"}, 4.2,
            "the agent stopped at an appliance, 1.8 m from the nearest clothes.",
        ),
    ],
)  # fmt: skip
def test_the_explanation_of_the_end_has_the_number_of_its_noun(
    line: dict, nearest_m: float | None, expected: str
) -> None:
    fixed = {"success": 0.0, "spl": 0.5, "num_steps": 9, "path_length": 3.0, "shortest_path": 2.0}
    outcome = explain_end(a_result(**fixed | line), "clothes", SuccessRule(), nearest_m, detects=True)
    assert expected in outcome.sentence


@pytest.mark.parametrize("semantics", ["gt", "noisy"])
def test_reading_the_agents_perception_twice_changes_nothing(house: Path, semantics: str) -> None:
    truth = (*VIEWER_IMAGES, "geom")
    env = ObjectNavEnv(house=house, sensors=(), truth=truth, camera=CameraModel(width_px=64, height_px=48))
    segmenter = make_segmenter(semantics, env)
    observation, _ = env.reset(seed=3, options={"episode": EPISODE})
    asked = AskedSegmenter(segmenter, semantics)
    assert asked.perceived(observation, "sofa") is None  # the agent has not asked
    first = asked.scores(observation, "sofa")
    seen = asked.perceived(observation, "sofa")
    assert seen is not None
    assert seen.categories is not None
    assert seen.scores is not None
    np.testing.assert_array_equal(seen.scores.target, first.target)
    assert seen.categories.shape == first.target.shape
    stride = 48 // len(first.target)
    true = env.truth_images["semantic"][stride // 2 :: stride, stride // 2 :: stride]
    assert (seen.categories == true).mean() > 0.3
    env.close()


def test_only_obstacles_that_nothing_visible_covers_are_tinted() -> None:
    house = with_box(room(6, 6), "window_00", centre_m=(1.5, 0, 1.0), half_m=(0.01, 1.0, 1.0), group=3)  # a pane
    house = with_box(house, "table_00", centre_m=(-1, 1, 0.7), half_m=(0.5, 0.4, 0.02))
    house = with_box(
        house, "table_01", centre_m=(-1, 1, 0.7), half_m=(0.48, 0.38, 0.02), group=3
    )  # what collides of it
    house = with_box(house, "floor_02", centre_m=(0, 0, -0.05), half_m=(3, 3, 0.02), group=3)
    table = house.spec.worldbody.add_body(name="table_02", pos=(-1.8, -1.7, 0.4))
    for x_m, y_m in itertools.product((-0.6, 0.6), repeat=2):
        table.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, pos=(x_m, y_m, 0), size=(0.02, 0.02, 0.4))
    table.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, name="hull", size=(0.6, 0.6, 0.4), group=3)
    table.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, name="glass", pos=(0, 0, 0.4), size=(0.6, 0.6, 0.005), group=3)
    world = World(house)
    hidden = {world.model.geom(geom).name for geom in np.flatnonzero(hidden_obstacles(world))}
    assert hidden == {"window_00", "glass"}
