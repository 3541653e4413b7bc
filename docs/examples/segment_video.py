"""Moving objects of a video, step by step: run it as a script, or cell by cell in an editor that knows ``# %%``.

Usage: python segment_video.py [VIDEO [FOLDER]]

Without VIDEO a small scene is rendered; results go to FOLDER (default: example).
"""

# %% What is to be segmented: a path, or an array uint8 (frame, y, x, 3)
import sys
from pathlib import Path

import moseg

arguments = sys.argv[1:] if "ipykernel" not in sys.modules else []
folder = Path(arguments[1] if len(arguments) > 1 else "example")
if arguments:
    video = arguments[0]
else:
    from moseg.tasks.synthetic import SCENES, render_scene

    video = render_scene(SCENES["two-motions"]).images[:10]

# %% Segment it. What is in the store already is not computed again: call it twice.
result = moseg.segment_video(video, quality="fast", store=folder / "store", name="example")
print(result)
print(f"{result.store_use.computed} artifacts computed, {result.store_use.reused} reused")

# %% The objects that move on their own
for each in result.objects:
    print(f"object {each.identity}: motion {each.motion}, frames {each.first_frame} to {each.last_frame}")
    print(f"  {100 * each.mean_area_fraction:.1f} % of the frame, score {each.score}")
    print(f"  static support by motion model: {each.static_support}")

# %% Labels: uint16 (frame, y, x), 0 is static, other values are identities
print(result.labels.shape, result.labels.dtype)
print(f"{100 * result.moving.mean():.1f} % of all pixels move")

# %% One frame at a time, for videos that do not fit into memory
largest = max(int((labels > 0).sum()) for labels in result.iter_labels())
print(f"at most {largest} moving pixels in a frame")

# %% Look at it: a notebook shows `result` or a figure by itself
style = moseg.OverlayStyle(mode="outline", opacity=0.3, outline_width=3)
result.figure(6, style=style).save(folder / "figure.png")

# %% Why: affinity between the background (row 0) and the objects under each motion model
print("rows:", result.row_identities)
for model, affinity in result.affinities.items():
    print(model, affinity.round(3).tolist())

# %% Files: masks/*.png, overlay.mp4 and motion.json, as `moseg segment` writes them
print("written:", *result.save(folder / "out", exports=["npz"]))
