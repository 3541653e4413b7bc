"""YTVOS-Moving (Dave et al. 2019): sequences of YouTube-VOS in which every labelled object moves and no other does.

The 101 validation sequences are drawn from YouTube-VOS's training part. Their list belongs to its authors and is given
by the user.
"""

from moseg.workflows.datasets.two_trees import TwoTrees

YTVOS_MOVING = TwoTrees(
    name="ytvos-moving",
    frames="JPEGImages",
    masks="Annotations",
    kind="instance",
    void=None,
    official=None,
    list_name="moving_val.txt",
    ground_truth="instance masks, every 5th frame",
    source=(
        "YouTube-VOS 2018 train from https://youtube-vos.org, and the list of validation sequences from "
        "https://github.com/achalddave/segment-any-moving"
    ),
)
