"""Small inputs in place of those that the documents name: a video, data sets, cues, weights, a store with a run.

All are made from one scene of the embedded synthetic data set.
"""

import json
import shutil
import subprocess
from pathlib import Path

import av
import numpy as np
from PIL import Image
from scipy.io import savemat

from moseg.tasks.synthetic import SCENES, RenderedScene, render_scene
from moseg.workflows.exports import davis_palette

SCENE, NUM_FRAMES, FRAME_RATE = "two-motions", 6, 8
STILL = "parked-cars,picture-00000,davis-blackswan,rendered-street"
"""A sequence of each kind in which nothing moves: a recording, a picture, a first frame of DAVIS, and a scene."""
MOST_TRACKS = 120
DAVIS = ("blackswan", "bmx-trees", "car-shadow", "cows", "dog", "drift-straight", "parkour", "soapbox")
CLIPS = ("Seq005_Clip01", "Seq009_Clip01")
TRACKS = {
    "kt3dmoseg": CLIPS,
    "hopkins12": ("oc1R2RC_g12_Tracks/oc1R2RC_g12",),
    "mtpv62": ("Hopkins50_cars4_Tracks/Hopkins50_cars4", "MTPV_data_Boat_Tracks/MTPV_data_Boat"),
}
"""Files of trajectories below the root of each data set, without their common end."""
SEED_RUN = ("eval", "--dataset", "synthetic", "--sequences", SCENE, "--variant", "fused", "--quiet")


def write_stand_ins(folder: Path, moseg: Path) -> None:
    """Write all stand-ins below a folder.

    ``clip.mp4`` (also in ``clips/``), ``frames/`` (also as ``holiday-frames/``), ``masks/``, ``flow/``, ``depth/``,
    ``tracks/`` and ``results/`` belong to one video; ``data/`` holds the data sets, ``weights/`` tiny checkpoints,
    ``store/`` a store with one run.
    """
    scene = render_scene(SCENES[SCENE].model_copy(update={"num_frames": NUM_FRAMES}))
    masks = scene.moving.astype(np.uint8)
    write_video(folder / "clip.mp4", scene.images)
    (folder / "clips").mkdir()
    # As the same videos by other names are, which pages segment into the same folders.
    for name in ("one.mp4", "two.mov"):
        shutil.copy(folder / "clip.mp4", folder / "clips" / name)
    _write_images(folder / "frames", scene.images, ".png")
    (folder / "holiday-frames").symlink_to("frames", target_is_directory=True)
    _write_masks(folder / "masks", masks)
    _write_arrays(folder / "flow" / "forward", scene.flow_forward)
    _write_arrays(folder / "flow" / "backward", scene.flow_backward)
    _write_arrays(folder / "depth", scene.inverse_depth)
    (folder / "tracks").mkdir()
    np.savez(folder / "tracks" / "tracks.npz", points=scene.points, visible=scene.visible)
    for name in DAVIS:
        _write_masks(folder / "results" / name, masks)
    _write_data(folder / "data", scene, masks)
    for command in (("weights", "tiny", str(folder / "weights")), (*SEED_RUN, "--store", str(folder / "store"))):
        subprocess.run([str(moseg), *command], check=True, capture_output=True)
    own = {"name": "my-raft", "architecture": "raft", "licence": "MIT", "files": [{"name": "model.pth"}]}
    listed = folder / "weights" / "weights.json"
    items = json.loads(listed.read_text(encoding="utf-8"))["items"]
    listed.write_text(json.dumps({"items": [*items, own]}), encoding="utf-8")
    (folder / "weights" / "my-raft").symlink_to(folder / "weights" / "raft-large", target_is_directory=True)


def write_video(path: Path, images: np.ndarray) -> None:
    """Write an H.264 video of frames uint8 (frame, y, x, rgb)."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=FRAME_RATE)
        stream.height, stream.width = images.shape[1:3]
        stream.pix_fmt = "yuv420p"
        for image in images:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())


def _write_data(data: Path, scene: RenderedScene, masks: np.ndarray) -> None:
    """Write the data sets, each below a folder of its name and below the root that the documents give."""
    for name in DAVIS:
        for root, labels in (("davis16", 255 * (masks > 0)), ("davis-moving", masks)):
            _write_images(data / root / "JPEGImages" / "480p" / name, scene.images, ".jpg")
            _write_masks(data / root / "Annotations" / "480p" / name, labels.astype(np.uint8))
    youtube = data / "ytvos-moving"
    _write_images(youtube / "JPEGImages" / "0a49f5265b", scene.images, ".jpg")
    _write_masks(youtube / "Annotations" / "0a49f5265b", masks, step=5)
    (youtube / "moving_val.txt").write_text("0a49f5265b\n", encoding="utf-8")
    for name, paths in TRACKS.items():
        for path in paths:
            _write_trajectories(data / name / f"{path}_Tracks.mat", scene)
    for name in ("1R2RC_g12", "cars4"):
        _write_trajectories(data / "hopkins155" / name / f"{name}_truth.mat", scene)
    for name in CLIPS:
        _write_images(data / "kt3dinsmoseg" / name / "images", scene.images, ".png")
        _write_masks(data / "kt3dinsmoseg" / name / "masks", masks)
    _write_images(data / "still" / "parked-cars" / "frames", scene.images, ".jpg")
    _write_images(data / "still" / "stills", scene.images[:1], ".jpg")
    _write_images(data / "folder" / "garden" / "frames", scene.images, ".jpg")
    _write_masks(data / "folder" / "garden" / "masks", masks)
    other_names = {"DAVIS": "davis16", "KT3DMoSeg": "kt3dmoseg", "KT3DInsMoSeg": "kt3dinsmoseg"}
    other_names |= {"Hopkins155": "hopkins155", "Hopkins12": "hopkins12", "MTPV62": "mtpv62"}
    other_names |= {"DAVIS-2017": "davis-moving", "YouTube-VOS": "ytvos-moving", "videos": "folder"}
    for other, name in other_names.items():
        (data / other).symlink_to(name, target_is_directory=True)


def _write_images(folder: Path, images: np.ndarray, suffix: str) -> None:
    folder.mkdir(parents=True)
    for number, image in enumerate(images):
        Image.fromarray(image).save(folder / f"{number:05d}{suffix}", quality=95)


def _write_masks(folder: Path, masks: np.ndarray, step: int = 1) -> None:
    folder.mkdir(parents=True)
    for number in range(0, len(masks), step):
        image = Image.fromarray(masks[number])
        image.putpalette(davis_palette().tobytes())
        image.save(folder / f"{number:05d}.png")


def _write_arrays(folder: Path, arrays: np.ndarray) -> None:
    folder.mkdir(parents=True)
    for number, array in enumerate(arrays):
        np.save(folder / f"{number:05d}.npy", array)


def _write_trajectories(path: Path, scene: RenderedScene) -> None:
    """Write points that every frame shows, labelled by their motion from 1 on, in the layout that the name tells."""
    x, y = np.rint(scene.points[:, 0]).astype(int).T
    shown = scene.visible.all(axis=1)
    motion = scene.moving[0][np.clip(y, 0, scene.moving.shape[1] - 1), np.clip(x, 0, scene.moving.shape[2] - 1)]
    _, labels = np.unique(motion[shown], return_inverse=True)
    chosen = np.concatenate([np.flatnonzero(labels == label)[:MOST_TRACKS] for label in range(labels.max() + 1)])
    points = scene.points[shown][chosen].transpose(2, 0, 1).astype(np.float64)
    homogeneous = np.concatenate([points, np.ones_like(points[:1])])
    motions = labels[chosen] + 1.0
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.name.endswith("_truth.mat"):
        savemat(path, {"y": homogeneous, "s": motions})
    else:
        fields = {"ySparse": homogeneous, "visibleSparse": np.ones(points.shape[1:]), "GtLabel": motions}
        savemat(path, {"Data": fields})
