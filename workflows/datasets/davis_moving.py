"""DAVIS-Moving (Dave et al. 2019): sequences of DAVIS-2017 in which every labelled object moves and no other does."""

from moseg.workflows.datasets.two_trees import TwoTrees

VALIDATION = """
bike-packing blackswan bmx-trees car-shadow cows dance-twirl dog dogs-jump drift-chicane drift-straight goat
horsejump-high judo kite-surf libby mbike-trick motocross-jump paragliding-launch parkour pigs shooting soapbox
"""
"""Sequences of DAVIS-2017 val in the list of Dave et al."""

DAVIS_MOVING = TwoTrees(
    name="davis-moving",
    frames="JPEGImages/480p",
    masks="Annotations/480p",
    kind="instance",
    void=255,
    official=tuple(VALIDATION.split()),
    list_name=None,
    ground_truth="instance masks, every frame; 255 is void",
    source="DAVIS 2017 TrainVal, 480p, from https://davischallenge.org/davis2017/code.html",
)
