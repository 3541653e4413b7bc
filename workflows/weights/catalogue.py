"""The weights items that this project knows.

Sizes and SHA-256 are given where public material states them; the files themselves were not at hand when this was
written. If there is no digest, the address names a commit, and Git LFS records the file's digest at that commit. If
there is no commit either (``main``), the one found at the first download is recorded and kept.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from moseg.schemas.weights import WeightsFile, WeightsItem

HUB = "https://huggingface.co"
NO_COMMIT = "main"
APACHE, BSD, MIT, CC_BY_NC = "Apache-2.0", "BSD-3-Clause", "MIT", "CC-BY-NC-4.0"
SAM_LICENCE = "SAM-License"
"""Commercial use is allowed; military, nuclear and espionage uses, weapons and reverse engineering are not."""

RAM_COMMIT = "7cb804a8609e9f4b1a50b7f31436d2df40bb9481"
RAM_DATA = f"https://raw.githubusercontent.com/xinyu1205/recognize-anything/{RAM_COMMIT}/ram/data"
TAG_FILES = (
    WeightsFile(
        name="tags.txt",
        url=f"{RAM_DATA}/ram_tag_list.txt",
        size=41_904,
        sha256="5d96d2f7225527480ad773aaac76b6e5c08a18adf6eae9ca7d2ab923d5e7bd8b",
    ),
    WeightsFile(
        name="thresholds.txt",
        url=f"{RAM_DATA}/ram_tag_list_threshold.txt",
        size=22_016,
        sha256="b6f81d0de1bc7f9c251af512c413eae976c77dbfbadf700d4e3d90510f4c6447",
    ),
)

BERT_VOCABULARY = (231_508, "07eced375cec144d27c900241f3e339478dec958f92fddbc551f295c992038a3")
DPT_DINOV2_BYTES = {"small": 149_000_000, "base": 448_000_000, "large": 1_359_000_000, "giant": 4_798_000_000}
DPT_DINOV2_RANGES = {
    "nyu": {"min_depth": 0.001, "max_depth": 10.0},
    "kitti": {"min_depth": 0.001, "max_depth": 80.0},
}
"""Depths to which the authors' code limits its answer, m (``_get_depth_range`` in ``dinov2/hub/depthers.py``)."""
GROUNDING_DINO_IMAGES = (457, "8454179ba95e2ad22947835aad7b45862a601fc0055ab88bf1ee70892d3aea60")

Known = tuple[int | None, str | None]
"""Size and SHA-256 of a file, as far as they are known."""
UNKNOWN: Known = (None, None)


def _hub_item(
    name: str,
    architecture: str,
    repository: str,
    commit: str,
    files: dict[str, Known],
    remote: dict[str, str] | None = None,
    licence: str = APACHE,
    approximate_size: int | None = None,
    others: tuple[WeightsFile, ...] = (),
    config: Mapping[str, Any] = MappingProxyType({}),
) -> WeightsItem:
    """Return an item from one repository of the hub; `remote` gives the files' names there if they differ."""
    base = f"{HUB}/{repository}/resolve/{commit}"
    remote_names = remote or {}
    return WeightsItem(
        name=name,
        architecture=architecture,
        licence=licence,
        is_non_commercial=licence == CC_BY_NC,
        has_conditions=licence == SAM_LICENCE,
        files=tuple(
            WeightsFile(name=file, url=f"{base}/{remote_names.get(file, file)}", size=size, sha256=sha256)
            for file, (size, sha256) in files.items()
        )
        + others,
        homepage=f"{HUB}/{repository}",
        approximate_size=approximate_size,
        config=dict(config),
    )


def _raft(name: str, file: str, size: int, sha256: str) -> WeightsItem:
    url = f"https://download.pytorch.org/models/{file}"
    return WeightsItem(
        name=name,
        architecture="raft",
        licence=BSD,
        files=(WeightsFile(name="model.pth", url=url, size=size, sha256=sha256),),
        homepage="https://docs.pytorch.org/vision/stable/models/raft.html",
    )


def _sea_raft(size: str, commit: str, known: Known, num_bytes: int) -> WeightsItem:
    """Return an item whose training ended on Spring, as the authors take for images of any kind."""
    files, repository = {"model.safetensors": known}, f"MemorySlices/Tartan-C-T-TSKH-spring540x960-{size.upper()}"
    name = f"sea-raft-{size}"
    return _hub_item(name, "sea_raft", repository, commit, files, licence=BSD, approximate_size=num_bytes)


def _ram(name: str, architecture: str, repository: str, commit: str, file: str, known: Known) -> WeightsItem:
    return _hub_item(
        name, architecture, repository, commit, {"model.pth": known}, {"model.pth": file}, others=TAG_FILES
    )


def _grounding_dino(size: str, commit: str, config: Known, model: Known) -> WeightsItem:
    files = {
        "config.json": config,
        "model.safetensors": model,
        "preprocessor_config.json": GROUNDING_DINO_IMAGES,
        "vocab.txt": BERT_VOCABULARY,
    }
    repository = f"IDEA-Research/grounding-dino-{size}"
    return _hub_item(f"grounding-dino-{size}", "grounding_dino", repository, commit, files)


def _sam_hq(size: str, commit: str, num_bytes: int) -> WeightsItem:
    files = {"config.json": UNKNOWN, "model.safetensors": UNKNOWN}
    repository = f"syscv-community/sam-hq-vit-{size}"
    return _hub_item(f"sam-hq-vit-{size}", "sam_hq", repository, commit, files, approximate_size=num_bytes)


def _sam2(size: str, commit: str, config: Known, model: Known) -> WeightsItem:
    files = {"config.json": config, "model.safetensors": model}
    return _hub_item(f"sam2.1-hiera-{size}", "sam2", f"facebook/sam2.1-hiera-{size}", commit, files)


def _dpt_dinov2(size: str, trained_on: str, commit: str, sha256: str) -> WeightsItem:
    name = f"dpt-dinov2-{size}-{trained_on}"
    files = {"config.json": UNKNOWN, "model.bin": (None, sha256)}
    remote = {"model.bin": "pytorch_model.bin"}
    num_bytes = DPT_DINOV2_BYTES[size]
    repository, depths = f"facebook/{name}", DPT_DINOV2_RANGES[trained_on]
    return _hub_item(name, "dpt_dinov2", repository, commit, files, remote, approximate_size=num_bytes, config=depths)


def _depth_anything(size: str, commit: str, config: Known, model: Known, licence: str) -> WeightsItem:
    files = {"config.json": config, "model.safetensors": model}
    repository = f"depth-anything/Depth-Anything-V2-{size.capitalize()}-hf"
    name = f"depth-anything-v2-{size}"
    return _hub_item(name, "depth_anything", repository, commit, files, licence=licence)


def _depth_anything_3(size: str, commit: str, config: Known, model: Known) -> WeightsItem:
    files = {"config.json": config, "model.safetensors": model}
    repository = f"depth-anything/DA3-{size.upper()}"
    return _hub_item(f"depth-anything-3-{size}", "depth_anything_3", repository, commit, files)


CATALOGUE: tuple[WeightsItem, ...] = (
    _raft(
        "raft-large",
        "raft_large_C_T_SKHT_V2-ff5fadd5.pth",
        21_106_607,
        "ff5fadd56d26b40647388883af1547351ea17868b765c05b27231e72dd16a322",
    ),
    _raft(
        "raft-small",
        "raft_small_C_T_V2-01064c6d.pth",
        4_006_189,
        "01064c6dba73b0fc9fc8edf772248560a00a3acfd62ac6677e9eeebad9680e27",
    ),
    _sea_raft(
        "m",
        "ac10cb373b8a518481c682b138947798025f90e0",
        (None, "cb8cfbf14c5e0f6734b64add383708b7ff68cc6089a0007c67165d4761346102"),
        78_800_000,
    ),
    _sea_raft("s", NO_COMMIT, UNKNOWN, 35_600_000),
    _hub_item(
        "pips",
        "pips",
        "aharley/pips",
        NO_COMMIT,
        {"model.pth": UNKNOWN},
        {"model.pth": "model-000200000.pth"},
        licence=MIT,
        approximate_size=344_000_000,
    ),
    WeightsItem(
        name="bootstapir",
        architecture="bootstapir",
        licence=APACHE,
        files=(
            WeightsFile(
                name="model.pth",
                url="https://storage.googleapis.com/dm-tapnet/bootstap/bootstapir_checkpoint_v2.pt",
                size=218_886_140,
                sha256="8493c7a69e02c85b9382fbb3c7b8b539b36bc08ede744b9e99feb739a0129f4b",
            ),
        ),
        homepage="https://github.com/google-deepmind/tapnet",
    ),
    WeightsItem(
        name="deaot-r50-l",
        architecture="deaot",
        licence=BSD,
        files=(
            WeightsFile(
                name="model.pth",
                url="https://drive.usercontent.google.com/download"
                "?id=1QoChMkTVxdYZ_eBlZhK2acq9KMQZccPJ&export=download&confirm=t",
                size=236_513_959,
                sha256="7e8a8d83310739bac02817f6bf48b6bbe2bbd7d5325722f1084088eb3aee1e06",
            ),
        ),
        homepage="https://github.com/yoxu515/aot-benchmark/blob/main/MODEL_ZOO.md",
    ),
    _ram(
        "ram",
        "ram",
        "xinyu1205/recognize_anything_model",
        NO_COMMIT,
        "ram_swin_large_14m.pth",
        (5_625_634_877, "15c729c793af28b9d107c69f85836a1356d76ea830d4714699fb62e55fcc08ed"),
    ),
    _ram(
        "ram-plus",
        "ram_plus",
        "xinyu1205/recognize-anything-plus-model",
        "6afd703f04b23e1c18d4c7d9882c4f5f954848f8",
        "ram_plus_swin_large_14m.pth",
        (3_010_210_801, "497c178836ba66698ca226c7895317e6e800034be986452dbd2593298d50e87d"),
    ),
    _grounding_dino(
        "tiny",
        "a2bb814dd30d776dcf7e30523b00659f4f141c71",
        (1_644, "eec82c5ab66e16df12a9a212e68ac011779927c2536cf9078658e35d85f0c67a"),
        (689_359_096, "1a2412ef99bd74bcd3c2a246fa1e48581f8889a1300c9051974741314fc042f3"),
    ),
    _grounding_dino(
        "base",
        "12bdfa3120f3e7ec7b434d90674b3396eccf88eb",
        (1_737, "eda416dae6f49419ff831b1c190ec430a060b19aae688dbaf2425a075b650608"),
        (933_400_872, "5548f844c928c4b6f411fa8cbcc2bfa8dbbba437cb1d513975519f93c2a9ed21"),
    ),
    _sam_hq("base", NO_COMMIT, 379_000_000),
    _sam_hq("large", NO_COMMIT, 1_255_000_000),
    _sam_hq("huge", "9d9d53502fbf666297e7eb3804f64137f930055e", 2_571_000_000),
    _hub_item(
        "edgetam",
        "edgetam",
        "yonigozlan/EdgeTAM-hf",
        NO_COMMIT,
        {"config.json": UNKNOWN, "model.safetensors": UNKNOWN},
        approximate_size=56_000_000,
    ),
    _hub_item(
        "sam3",
        "sam3",
        "facebook/sam3",
        "3c879f39826c281e95690f02c7821c4de09afae7",
        {
            "config.json": (25_843, None),
            "model.safetensors": (
                3_439_938_512,
                "6d06f0a5f84e435071fe6603e61d0b4cc7b40e0d39d487cfd4d67d8cc11cc14a",
            ),
            "vocab.json": (862_328, None),
            "merges.txt": (524_619, None),
        },
        licence=SAM_LICENCE,
    ),
    _sam2(
        "tiny",
        "de431c4043854a71d8101e17995dfe596bf101a5",
        (5_695, "860aff9751b139d83a4ad7df1e5535416fded533e0ead02625edbefcb9953cce"),
        (155_908_064, "48c14467e5cf9e51870511feb72c89688e82dd74523142c0538b663e193ac2a7"),
    ),
    _sam2(
        "small",
        "ee5bba1d82bb8749febdf90f45e84b687142ba03",
        (5_698, "97ff9f65b76d107acda4247885f0a5555d0048850ae3c5f97183df289aaecde9"),
        (184_305_280, "0a4067b11ce1e23d5229203f11c718a823060d15a4b23fa2372a7d4b77cbbc60"),
    ),
    _sam2(
        "base-plus",
        "b7320756a13354e7530a63935656d35b2f91a290",
        (5_705, "8e24a93b6a40d4dad86eaec383ce7b4044f37ec6360136460f5ff2ce55f87390"),
        (323_476_296, "2012733a0de5d03efd1bba550a2847c4551be9ef2e0d497c83074df66189f780"),
    ),
    _sam2(
        "large",
        "665f8e2ad61cf5f53d65644ff27c8ee525124610",
        (5_705, "00446988cf4d617118d2d347eabe2c46aebed744628facdd540508be30b69ec3"),
        (897_897_416, "dc407dce21301fd94abb395c5099b4f2c455fdc8a8f261ac3d0ea6d4cd197230"),
    ),
    _dpt_dinov2(
        "small",
        "nyu",
        "21a14468819a6aa4a1bbe56d872ba8be23184b0f",
        "16f263f1793476fe83a10c02da0897573935b4ddb640123c213b39f672649e2a",
    ),
    _dpt_dinov2(
        "small",
        "kitti",
        "c0d86b8c609b96365202ba99a2065e2b549ad782",
        "d75e96bdb1355fb9075aa3ecd727daa78fbd2887f6c02dbf410aa4b0237a6ba8",
    ),
    _dpt_dinov2(
        "base",
        "nyu",
        "5776fdeb81586a1563c9a4414d47e4156b3ea9b1",
        "6f09db8fd5a5368934ac7eb0ab9881b1fb059d9b85c08ce916ada16f030b22c1",
    ),
    _dpt_dinov2(
        "base",
        "kitti",
        "e388c90f97fd01c1e3fa393fad136b3be1dd71d0",
        "85f648db0567d70d2b9434559d1a79c0bdb1d64aca37ae8e59820256d17ff3d1",
    ),
    _dpt_dinov2(
        "large",
        "nyu",
        "ef81b2d74ef33a42107b498206e889d3b2a10c27",
        "d4dedbe0ca27012862c1f32128d4f7db9b528dc831e28dbee9d7abe10ba48705",
    ),
    _dpt_dinov2(
        "large",
        "kitti",
        "8c762dd3921556d73ba9f4c6af96665feb5195c7",
        "27b17137a546badf93285fba5d5a4cb6bd09974601a5477848a602a271a07c41",
    ),
    _dpt_dinov2(
        "giant",
        "nyu",
        "c18b63c9ecc1c5e868d240dc8f58ab5e56e8e1a1",
        "2850413a96d137e46a4f75563ecbedf47387bb7fca8fd9a078b00420e340e829",
    ),
    _dpt_dinov2(
        "giant",
        "kitti",
        "a2ad1f6f221e58dc561e2f8bc98cd705f6bde7fb",
        "71bb74fe8c73bbb078da13e12a1efe67667b018a015b02708f6fa444d745e444",
    ),
    _depth_anything(
        "small",
        "5426e4f0f36572d16453bbda7a8389317b1bef99",
        (950, "c56698d3643dde1f83ea2212759e6b31a22b8f827246a36dd007ee8a22b3ff75"),
        (99_173_660, "3152477ce0d8d6978d76b995120de97cb5b928701fd0f817769f59e249a16b70"),
        APACHE,
    ),
    _depth_anything(
        "base",
        "b1958afc87fb45a9e3746cb387596094de553ed8",
        (953, None),
        (389_916_980, None),
        CC_BY_NC,
    ),
    _depth_anything(
        "large",
        "7581137eff8d4e94f6e796d3baea0e9fa79b22d2",
        (1_431, "0ceca59ffa2350fb7c19e4565e2e5d28e2d491ec296ba91ab8c779474f9a7458"),
        (1_341_322_868, "4e01e34ed5549b529b70b92d53226bc370f03041977b390d3dde45d47f516cf9"),
        CC_BY_NC,
    ),
    _depth_anything_3(
        "small",
        "e08cab65ca0ec38e7826075418411ab90cab4da3",
        (1_202, "a486e29e82b7ab4a7d4cefc1ea4526cfe2ae438a572c8ca98917cfbcde7447d2"),
        (137_248_940, "364492e38a3a06d221ac75da7f6621ada3f2361cd24fde11ba79091e9f40efcf"),
    ),
    _depth_anything_3(
        "base",
        "f4a6c9b3c95e41c82048423d3493a81ec3fa810e",
        (1_205, None),
        (541_518_028, "e01067dc1659613083d9145a9a2547ccdbe6ccbbf83c4fe7b3e8a4e2bdae78b5"),
    ),
)
