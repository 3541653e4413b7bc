"""A page about a video of several scenes: frames of the whole, and the matrices of each scene."""

import shutil

import pytest

OPTIONS = ("--section-length", "4", "--set", "sections.overlap=2")
CUT, NUM_FRAMES = 6, 11


@pytest.fixture(scope="module")
def film(write_squares, tmp_path_factory):
    """Return the folder of the frames of two shots, joined."""
    folder = tmp_path_factory.mktemp("film")
    lengths = CUT, NUM_FRAMES - CUT
    (folder / "frames").mkdir()
    for seed, length in zip((0, 7), lengths, strict=True):
        shot = write_squares(folder / str(seed), num_frames=length, seed=seed) / "frames"
        for number, path in enumerate(sorted(shot.iterdir())):
            shutil.copy(path, folder / "frames" / f"{(CUT if seed else 0) + number:05}{path.suffix}")
    return folder / "frames"


def test_a_page_shows_the_whole_film(serve, film, tmp_path, moseg):
    out, store = tmp_path / "out", tmp_path / "store"
    arguments = ("segment", film, "--out", out, "--store", store, "--keep-cues", "--quiet", *OPTIONS)
    assert moseg(*arguments).code == 0
    server = serve(out, "--store", store)
    result = server.wait("ready")["result"]
    assert result["numFrames"] == NUM_FRAMES
    grid = server.ask("GET", f"grid/{result['key']}").json()
    spans = [(entry["first"], entry["last"]) for entry in grid["objects"].values()]
    assert spans and all(last < CUT or first >= CUT for first, last in spans)
    matrices = server.ask("GET", f"matrices/{result['key']}").json()["matrices"]
    scenes = [f"frames 0 to {CUT - 1}", f"frames {CUT} to {NUM_FRAMES - 1}"]
    assert {matrix["title"].split(", ", 1)[1] for matrix in matrices if "kernel" in matrix["title"]} == {*scenes}
    # As from the last frame of the film, the flow leads to no frame from the last one before the cut.
    flow = [cue["name"] for cue in result["cues"]].index("optical flow")
    statuses = [server.ask("GET", f"cues/{flow}/{frame}").status for frame in (CUT - 1, CUT, NUM_FRAMES - 1)]
    assert statuses[1] == 200 and statuses[0] == statuses[2]
