"""DAVIS-2016 (Perazzi et al. 2016): one foreground a sequence, binary."""

from moseg.workflows.datasets.two_trees import TwoTrees

VALIDATION = """
blackswan bmx-trees breakdance camel car-roundabout car-shadow cows dance-twirl dog drift-chicane drift-straight goat
horsejump-high kite-surf libby motocross-jump paragliding-launch parkour scooter-black soapbox
"""
"""ImageSets/480p/val.txt of the data set."""

DAVIS16 = TwoTrees(
    name="davis16",
    frames="JPEGImages/480p",
    masks="Annotations/480p",
    kind="binary",
    void=None,
    official=tuple(VALIDATION.split()),
    list_name=None,
    ground_truth="binary masks, every frame",
    source="DAVIS 2016, 480p, from https://davischallenge.org/davis2016/code.html",
)
