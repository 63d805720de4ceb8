"""Maps in other files: tiny ones worked out by hand, and real ones where they are at hand."""

from __future__ import annotations

import math
import struct
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.files.maps.formats import read_map, read_movingai, read_ros_map
from teamformer.files.maps.images import read_image
from teamformer.files.mission_files import (
    mission_from_tree,
    mission_to_tree,
    read_mission,
    write_mission,
)
from teamformer.mission.parts.frame import Frame
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid

REAL_MAPS = Path(__file__).parents[2].parent / "shared" / "data" / "maps"
needs_real_maps = pytest.mark.skipif(not REAL_MAPS.is_dir(), reason="the real maps are not here")

ABOUT = """\
image: floor.pgm
resolution: 0.05
origin: [-1.0, -2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def ros_map(folder: Path, image: bytes, about: str = ABOUT) -> Path:
    (folder / "floor.pgm").write_bytes(image)
    (folder / "floor.yaml").write_text(about)
    return folder / "floor.yaml"


def movingai(folder: Path, text: str) -> Path:
    path = folder / "yard.map"
    path.write_text(text)
    return path


def test_movingai_cells_and_axes(tmp_path: Path) -> None:
    path = movingai(tmp_path, "type octile\nheight 2\nwidth 7\nmap\n.GS@OTW\n....@@.\n")
    grid = read_movingai(path)
    assert grid == Grid(7, 2, ("...@@@@", "....@@."), "down")
    assert grid.is_free((3, 1))  # the second line of the map is y = 1
    assert not grid.is_free((3, 0))


def test_movingai_with_windows_line_ends_and_width_first(tmp_path: Path) -> None:
    path = movingai(tmp_path, "type octile\r\nwidth 2\r\nheight 1\r\nmap\r\n.@\r\n\r\n")
    assert read_map(path) == Grid(2, 1, (".@",), "down")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "this is no MovingAI map: it has no line 'map'"),
        ("height 1\nmap\n.\n", "it has no 'width N' above 'map'"),
        ("height one\nwidth 1\nmap\n.\n", "it has no 'height N' above 'map'"),
        ("height 2\nwidth 1\nmap\n.", "2 rows are announced and 1 are there"),
        ("height 2\nwidth 2\nmap\n..\n.\n", r":5: this row has 1 cells, not 2"),
        ("height 9000\nwidth 9000\nmap\n..\n.\n", "81,000,000 cells; 4,200,000 are possible"),
    ],
)
def test_a_broken_movingai_map(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(TeamformerError, match=message) as caught:
        read_movingai(movingai(tmp_path, text))
    assert str(caught.value).startswith(str(tmp_path / "yard.map"))


def test_the_bottom_row_of_a_ros_image_is_y_0(tmp_path: Path) -> None:
    grid = read_ros_map(ros_map(tmp_path, b"P5 3 2 255\n" + bytes([255, 255, 0, 255, 0, 0])))
    assert grid == Grid(3, 2, (".@@", "..@"), "up", Frame(0.05, -1.0, -2.0, 0.0))


def test_the_trinary_rule_at_its_thresholds(tmp_path: Path) -> None:
    # Occupancy (255 - shade) / 255: 206 is 0.1922, free; 205 is 0.1961, unknown; 0 is 1, occupied.
    path = ros_map(tmp_path, b"P5 4 1 255\n" + bytes([254, 206, 205, 0]))
    assert read_ros_map(path).rows == ("..@@",)


def test_negated_images_are_free_where_they_are_black(tmp_path: Path) -> None:
    image = b"P5 4 1 255\n" + bytes([0, 49, 50, 255])  # 49 / 255 is 0.1922, 50 / 255 is 0.1961
    for value in ("1", "true"):
        about = ABOUT.replace("negate: 0", f"negate: {value}")
        assert read_ros_map(ros_map(tmp_path, image, about)).rows == ("..@@",)


def test_occupied_pixels_are_blocked_whatever_counts_as_free(tmp_path: Path) -> None:
    about = ABOUT.replace("0.65", "0.5").replace("0.196", "0.9")
    path = ros_map(tmp_path, b"P5 3 1 100\n" + bytes([60, 50, 49]), about)
    assert read_ros_map(path).rows == ("..@",)  # occupancies 0.4, 0.5 and 0.51


def test_a_cell_is_free_only_if_all_its_pixels_are(tmp_path: Path) -> None:
    """Draw five columns and three rows of pixels; cells of 2 x 2 begin at the bottom left.

    . . . @ .     the upper cells have one row of pixels,
    . . . . .     the right ones one column
    @ . . . .
    """
    image = b"P2 5 3 1\n1 1 1 0 1\n1 1 1 1 1\n0 1 1 1 1\n"
    grid = read_ros_map(ros_map(tmp_path, image), cell=0.1)
    assert grid == Grid(3, 2, ("@..", ".@."), "up", Frame(0.1, -1.0, -2.0, 0.0))


def test_downsampling_is_what_a_slow_loop_finds(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    for factor in (1, 2, 3, 7, 50):
        height, width = (int(n) for n in rng.integers(1, 20, 2))
        shades = np.where(rng.random((height, width)) < 0.1, 0, 255).astype(np.uint8)
        image = b"P5 %d %d 255\n" % (width, height) + shades.tobytes()
        grid = read_ros_map(ros_map(tmp_path, image), cell=0.05 * factor)
        upright = shades[::-1]
        for y in range(grid.height):
            for x in range(grid.width):
                pixels = upright[y * factor : (y + 1) * factor, x * factor : (x + 1) * factor]
                assert grid.rows[y][x] == (FREE if pixels.min() == 255 else BLOCKED)
        assert (grid.width, grid.height) == (-(-width // factor), -(-height // factor))


def test_plain_and_raw_images_say_the_same(tmp_path: Path) -> None:
    path = tmp_path / "image.pgm"
    texts = [
        b"P2\n# made by hand\n3 # wide\n2\n255\n0 1 2 # first\n253 254 255\n",
        b"P5\n# made by hand\n3 2\n# white:\n255\n" + bytes([0, 1, 2, 253, 254, 255]),
    ]
    for text in texts:
        path.write_bytes(text)
        image = read_image(path)
        assert image.white == 255
        assert image.shades.tolist() == [[0, 1, 2], [253, 254, 255]]


def test_raw_images_of_two_bytes_a_pixel(tmp_path: Path) -> None:
    path = tmp_path / "image.pgm"
    path.write_bytes(b"P5 2 1 65535\n" + struct.pack(">2H", 1, 65535))
    assert read_image(path).shades.tolist() == [[1, 65535]]


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (b"", "this is no PGM"),
        (b"\x89PNG\r\n", "this is no PGM"),
        (b"P5 #" + b" " * 100_000, "this is no PGM"),
        (b"P5 0 1 255\n", "no image has 0 x 1 pixels"),
        (b"P5 1 1 0\n0", "pixels up to 0"),
        (b"P5 2 2 255\nabc", "4 pixels are announced and 3 are there"),
        (b"P5 2 2 65535\nabc", "4 pixels are announced and 1 are there"),
        (b"P2 2 1 255\n1 x", "a pixel is no number from 0 to 65535"),
        (b"P2 2 1 255\n1 70000", "a pixel is no number from 0 to 65535"),
        (b"P2 2 1 255\n1 256", "a pixel is 256, brighter than white, 255"),
        (b"P5 999999 999999 255\n", "999998000001 pixels are announced and 0 are there"),
    ],
)
def test_a_broken_image(tmp_path: Path, image: bytes, message: str) -> None:
    with pytest.raises(TeamformerError, match=message) as caught:
        read_ros_map(ros_map(tmp_path, image))
    assert "floor.pgm" in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("image: floor.pgm\n", "", r"floor.yaml:1: the file lacks 'image'; add it"),
        ("image: floor.pgm", "image: 3", r"floor.yaml:1: YAML reads 3 as a number"),
        ("image: floor.pgm", "image: none.pgm", r"none.pgm: there is no such file"),
        ("resolution: 0.05", "resolution: 0", r"floor.yaml:2: resolution is 0.0; write"),
        ("resolution: 0.05", "resolution: 1e-320", r"floor.yaml:2: resolution is"),
        ("resolution: 0.05", "resolution: .nan", r"floor.yaml:2: resolution is nan"),
        ("negate: 0", "negate: 2", r"floor.yaml:4: negate is 2; write 0 or 1"),
        ("free_thresh: 0.196", "free_thresh: low", r"floor.yaml:6: free_thresh is the text 'low'"),
        ("0.65", "65", r"floor.yaml:5: occupied_thresh is 65; write it as a share, 0.65$"),
        ("0.196", "25", r"floor.yaml:6: free_thresh is 25; write it as a share, 0.25$"),
        ("0.196", "1.5", r"floor.yaml:6: free_thresh is 1.5; write it as a share, 0.015$"),
        ("0.65", "101", r"floor.yaml:5: occupied_thresh is 101; write a share from 0 to 1$"),
        ("0.65", "-0.1", r"floor.yaml:5: occupied_thresh is -0.1; write a share from 0 to 1$"),
        ("negate: 0", "mode: raw", r"floor.yaml:4: the mode is the text 'raw'; only trinary"),
        ("negate: 0", "negate: [", r"floor.yaml:\d+: this is not YAML"),
    ],
)
def test_a_broken_description(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = ros_map(tmp_path, b"P2 1 1 1\n1", ABOUT.replace(old, new))
    with pytest.raises(TeamformerError, match=message):
        read_ros_map(path)


@pytest.mark.parametrize(
    ("cell", "better"), [(0.12, "0.1"), (0.01, "0.05"), (0.0, "0.05"), (-1.0, "0.05")]
)
def test_a_cell_that_is_no_multiple_of_a_pixel(tmp_path: Path, cell: float, better: str) -> None:
    path = ros_map(tmp_path, b"P2 1 1 1\n1")
    with pytest.raises(TeamformerError, match=f"is no multiple of the map's 0.05 m; use {better}"):
        read_ros_map(path, cell)


def test_names_that_are_no_map(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="there is no such file"):
        read_map(tmp_path / "none.map")
    with pytest.raises(TeamformerError, match=r"no map; name a \.map or a map_server \.yaml"):
        read_map(tmp_path / "floor.png")
    with pytest.raises(TeamformerError, match=r"a \.map file has its cells already"):
        read_map(tmp_path / "yard.map", cell=0.5)


@needs_real_maps
@pytest.mark.parametrize(("percent", "free"), [(10, 922), (20, 819)])
def test_a_benchmark_map(percent: int, free: int) -> None:
    grid = read_map(REAL_MAPS / f"random-32-32-{percent}.map")
    assert (grid.width, grid.height, grid.y_axis) == (32, 32, "down")
    assert sum(row.count(FREE) for row in grid.rows) == free


@needs_real_maps
def test_a_map_made_by_a_robot() -> None:
    """Count the pixels of 254, which are free; 205 is unknown and 0 a wall."""
    path = REAL_MAPS / "turtlebot3_world.yaml"
    data = (REAL_MAPS / "turtlebot3_world.pgm").read_bytes()[-384 * 384 :]
    grid = read_ros_map(path)
    assert (grid.width, grid.height, grid.y_axis) == (384, 384, "up")
    assert sum(row.count(FREE) for row in grid.rows) == data.count(254) == 7939
    coarse = read_ros_map(path, cell=0.25)
    assert (coarse.width, coarse.height) == (77, 77)
    pixels = np.frombuffer(data, np.uint8).reshape(384, 384)[::-1]
    assert coarse.is_free((38, 38)) == bool((pixels[190:195, 190:195] == 254).all())
    assert sum(row.count(FREE) for row in coarse.rows) == sum(
        bool((pixels[y : y + 5, x : x + 5] == 254).all())
        for y in range(0, 384, 5)
        for x in range(0, 384, 5)
    )


def test_places_are_told_in_the_map_s_frame() -> None:
    """A cell of 0.5 m at (1, 2); turned by a quarter, along becomes up."""
    assert Frame(0.5, 1.0, 2.0).point((3, 0)) == (2.75, 2.25)
    turned = Frame(0.5, 1.0, 2.0, math.pi / 2).point((3, 0))
    assert turned == pytest.approx((0.75, 3.75))


def test_a_mission_on_a_ros_map_keeps_where_its_cells_lie(tmp_path: Path) -> None:
    about = ABOUT.replace("[-1.0, -2.0, 0.0]", "[-1.0, -2.0, 0.5]")
    ros_map(tmp_path, b"P5 4 2 255\n" + bytes([255] * 8), about)
    text = """
teamformer: 1
world: {map: floor.yaml, cell: 0.1}
capabilities: [a]
robots: [{at: [0, 0], can: [a]}]
tasks: [{at: [1, 0], needs: [a]}]
"""
    (tmp_path / "mission.yaml").write_text(text)
    mission = read_mission(tmp_path / "mission.yaml")
    assert isinstance(mission.world, Grid)
    assert mission.world.frame == Frame(0.1, -1.0, -2.0, 0.5)
    for name in ("copy.yaml", "copy.json"):
        write_mission(mission, tmp_path / name)
        assert read_mission(tmp_path / name).world == mission.world
    free = replace(mission, world=Grid(4, 2, frame=Frame(0.25)))
    assert mission_from_tree(mission_to_tree(free)).world == free.world


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        ("{cell: 0}", "a cell of the map is 0 m wide; use more than 0"),
        ("{cell: 1, origin: 3}", "the origin is 3; write it as [x, y, yaw]"),
        ("{cell: 1, origin: [3]}", "the origin lacks one number; write it as [x, y, yaw]"),
        ("{cell: 1, origin: [3, 0, 0, 0]}", "the origin has 4 numbers instead of 3; write it as"),
        ("{cell: 1, origin: [a, 0]}", "entry 1 of origin of frame of world is the text 'a'"),
        ("{origin: [0, 0]}", "frame of world lacks 'cell'; add it"),
    ],
)
def test_a_broken_frame_is_told(tmp_path: Path, frame: str, message: str) -> None:
    text = f"""
teamformer: 1
world: {{grid: [2, 1], frame: {frame}}}
capabilities: [a]
robots: [{{at: [0, 0], can: [a]}}]
tasks: [{{at: [1, 0], needs: [a]}}]
"""
    (tmp_path / "mission.yaml").write_text(text)
    with pytest.raises(MissionError) as error:
        read_mission(tmp_path / "mission.yaml")
    assert message in str(error.value)
    assert "mission.yaml:3: " in str(error.value)


def drawn(folder: Path, pixels: np.ndarray, ending: str = "png", **how: object) -> Path:
    """Write a map whose image Pillow makes of these pixels."""
    pillow = pytest.importorskip("PIL.Image")
    pillow.fromarray(pixels).save(folder / f"floor.{ending}", **how)
    (folder / "floor.yaml").write_text(ABOUT.replace("floor.pgm", f"floor.{ending}"))
    return folder / "floor.yaml"


def test_png_maps_are_what_pgm_maps_are(tmp_path: Path) -> None:
    """Grey, coloured (206 + 206 + 205 of 765 is 0.193, free), opaque throughout, and 16 bits."""
    grey = np.array([[254, 206, 205, 0]], np.uint8)
    assert read_ros_map(drawn(tmp_path, grey)).rows == ("..@@",)
    coloured = np.array(
        [[[255, 255, 255], [206, 206, 206], [205, 205, 205], [255, 0, 0]]], np.uint8
    )
    assert read_ros_map(drawn(tmp_path, coloured)).rows == ("..@@",)
    opaque = np.concatenate([coloured, np.full((1, 4, 1), 255, np.uint8)], axis=2)
    assert read_ros_map(drawn(tmp_path, opaque)).rows == ("..@@",)
    deep = np.array([[65535, 53000, 52600, 0]], np.uint16)  # 52687 is at the threshold
    assert read_ros_map(drawn(tmp_path, deep)).rows == ("..@@",)


@pytest.mark.parametrize("mode", ["trinary", "scale"])
@pytest.mark.parametrize("shade", [0, 255])
def test_pixels_that_are_erased_are_unknown(tmp_path: Path, mode: str, shade: int) -> None:
    """White, erased to nothing, to a half and a little; what colour is left does not matter."""
    for clear in (0, 128, 254):
        pixels = np.full((1, 3, 4), 255, np.uint8)
        pixels[0, 1] = (shade, shade, shade, clear)
        path = drawn(tmp_path, pixels)
        path.write_text(f"{path.read_text()}mode: {mode}\n")
        assert read_ros_map(path).rows == (".@.",)
        path.write_text(path.read_text().replace("negate: 0", "negate: 1"))
        assert read_ros_map(path).rows == ("@@@",)


@pytest.mark.parametrize(("kind", "clear"), [(np.uint8, 254), (np.uint16, 65000)])
def test_a_shade_that_a_png_calls_transparent_is_unknown(
    tmp_path: Path, kind: type, clear: int
) -> None:
    pixels: np.ndarray = np.array([[np.iinfo(kind).max, clear, 0]], kind)
    assert read_ros_map(drawn(tmp_path, pixels)).rows == ("..@",)
    assert read_ros_map(drawn(tmp_path, pixels, transparency=clear)).rows == (".@@",)


def test_colours_of_a_palette_may_be_transparent(tmp_path: Path) -> None:
    pillow = pytest.importorskip("PIL.Image")
    path = drawn(tmp_path, np.zeros((1, 3), np.uint8))
    image = pillow.fromarray(np.array([[0, 1, 2]], np.uint8), "P")
    image.putpalette([255, 255, 255, 254, 254, 254, 0, 0, 0])
    image.save(tmp_path / "floor.png", transparency=bytes([255, 0, 255]))
    assert read_ros_map(path).rows == (".@@",)


@pytest.mark.parametrize(("ending", "how"), [("bmp", {}), ("jpg", {"quality": 100})])
def test_jpeg_and_bmp_maps_are_read(tmp_path: Path, ending: str, how: dict[str, object]) -> None:
    pixels = np.full((8, 16), 254, np.uint8)  # JPEG keeps squares of eight
    pixels[:, 8:] = 0
    path = drawn(tmp_path, pixels, ending, **how)
    assert read_ros_map(path).rows == ("." * 8 + "@" * 8,) * 8
    data = (tmp_path / f"floor.{ending}").read_bytes()
    (tmp_path / f"floor.{ending}").write_bytes(data[: len(data) // 2])
    with pytest.raises(TeamformerError, match=rf"floor.{ending}: this \w+ cannot be read"):
        read_ros_map(path)


def test_a_robot_does_not_walk_through_a_column_that_was_erased(tmp_path: Path) -> None:
    pixels = np.full((3, 7, 4), 255, np.uint8)
    pixels[:, 3, 3] = 0
    drawn(tmp_path, pixels)
    text = """
teamformer: 1
world: {map: floor.yaml}
capabilities: [lift]
robots: [{name: a, at: [0, 1], can: [lift]}]
tasks: [{name: x, at: [6, 1], needs: [lift]}]
"""
    (tmp_path / "mission.yaml").write_text(text)
    with pytest.raises(MissionError, match="task 'x' cannot be reached"):
        read_mission(tmp_path / "mission.yaml")


@pytest.mark.parametrize("mode", ["TRINARY", "Trinary", "Scale"])
def test_modes_are_read_in_any_case(tmp_path: Path, mode: str) -> None:
    path = ros_map(tmp_path, b"P5 2 1 255\n" + bytes([254, 0]), f"{ABOUT}mode: {mode}\n")
    assert read_ros_map(path).rows == (".@",)


def test_thresholds_of_a_quarter_make_the_usual_unknown_free(tmp_path: Path) -> None:
    """Go by the file, as map_server does: 205 is an occupancy of 0.196."""
    path = ros_map(tmp_path, b"P5 2 1 255\n" + bytes([205, 0]), ABOUT.replace("0.196", "0.25"))
    assert read_ros_map(path).rows == (".@",)


def test_a_pointer_of_git_lfs_is_named(tmp_path: Path) -> None:
    pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"
    path = ros_map(tmp_path, pointer)
    (tmp_path / "mission.yaml").write_bytes(pointer)
    for read, file in ((read_ros_map, path), (read_mission, tmp_path / "mission.yaml")):
        with pytest.raises(TeamformerError, match="this is a pointer of Git LFS") as error:
            read(file)
        assert error.value.hint == "fetch the file by `git lfs pull`"


def test_a_broken_png_is_told(tmp_path: Path) -> None:
    path = drawn(tmp_path, np.zeros((40, 40), np.uint8))
    whole = (tmp_path / "floor.png").read_bytes()
    for length in (8, 30, len(whole) - 25):
        (tmp_path / "floor.png").write_bytes(whole[:length])
        with pytest.raises(TeamformerError, match=r"floor.png: this PNG cannot be read"):
            read_ros_map(path)


def test_without_pillow_a_png_is_refused_with_a_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = drawn(tmp_path, np.zeros((2, 2), np.uint8))
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(TeamformerError) as error:
        read_ros_map(path)
    assert error.value.hint == f"{how_to_install('maps')}, or convert it to PGM"
