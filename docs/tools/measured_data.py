"""Data sets that measurements need: placeholder of the root in a command, and the measured sequences.

Of each set of trajectories and of DAVIS, the other half is kept apart and is measured once, by others.
"""

from typing import NamedTuple

PARTS = ("", "_g12", "_g13", "_g23")
"""Ends of names in Hopkins155: a sequence of three motions, and its pairs of motions."""
_THREE_MOTIONS = (
    *("1R2RC", "1R2RCT_A", "1R2TCR", "1RT2RCR", "1RT2RTCRT_A", "1RT2TC", "1RT2TCRT_B"),
    *("2R3RTCRT", "2RT3RCR", "2RT3RCT_B", "2T3RCR", "2T3RCRTP", "2T3RTCR"),
    *("articulated", "cars2_07", "cars2B", "cars10", "two_cranes"),
)
_TWO_MOTIONS = ("cars4", "cars6", "cars8", "kanatani1", "kanatani3", "people2", "truck1")


class MeasuredData(NamedTuple):
    """Data set that must be given.

    Attributes
    ----------
    root : str
        Placeholder of its root in a command.
    about : str
        Content of the root.
    sequences : tuple of str
        Measured sequences.
    """

    root: str
    about: str
    sequences: tuple[str, ...]

    @property
    def arguments(self) -> str:
        """Root and sequences, as in a command."""
        return f"--root {self.root} --sequences {','.join(self.sequences)}"


DATA = {
    "davis": MeasuredData(
        "DAVIS",
        "folder of DAVIS-2016",
        ("blackswan", "bmx-trees", "car-shadow", "cows", "dog", "drift-straight", "parkour", "soapbox"),
    ),
    "kt3dmoseg": MeasuredData(
        "KT3DMOSEG",
        "folder of <clip>_Tracks.mat",
        (
            *("Seq005_Clip01", "Seq009_Clip01", "Seq009_Clip03", "Seq013_Clip01", "Seq028_Clip01", "Seq028_clip03"),
            *("Seq037_Clip01", "Seq038_Clip02", "Seq059_Clip01", "Seq071_Clip01", "Seq095_Clip01"),
        ),
    ),
    "hopkins155": MeasuredData(
        "HOPKINS155",
        "folder of Hopkins155",
        (*(f"{name}{part}" for name in _THREE_MOTIONS for part in PARTS), *_TWO_MOTIONS, "dancing"),
    ),
    "hopkins12": MeasuredData("HOPKINS12", "folder of Hopkins12", ("oc1R2RC", "oc1R2RC_g12", "oc2R3RCRT_g13")),
    "mtpv62": MeasuredData(
        "MTPV62",
        "folder of MTPV62",
        (
            *(f"Hopkins50_{name}" for name in (*_THREE_MOTIONS, *_TWO_MOTIONS)),
            *(f"MTPV_data_{name}" for name in ("Boat", "Bus", "Girl", "Man", "Swing")),
        ),
    ),
    "still": MeasuredData(
        "STILL",
        "folder of the data set still, DAVIS beside it",
        (
            *("rendered-bright-sky", "rendered-garden", "rendered-orbit", "rendered-roofs", "rendered-street"),
            *("rendered-wall", "kitti_parked_cars", "davis-blackswan", "davis-bmx-trees", "davis-car-shadow"),
            *("davis-cows", "davis-dog", "davis-drift-straight", "davis-parkour", "davis-soapbox"),
        ),
    ),
}
"""By the option of `write_results` that gives its root."""
TRACKS = ("kt3dmoseg", "hopkins155", "hopkins12", "mtpv62")
"""Those of trajectories without images."""
NUM_FRAMES = {"davis16": 583}
"""Number of measured frames, by data set."""
