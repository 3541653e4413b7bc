import numpy as np
import pytest

from moseg.schemas.parameters import ForegroundParams, MotionNetworkParams
from moseg.tasks.motion_network import join_evidence
from moseg.tasks.saliency.logits import motion_logit

FOREGROUND = ForegroundParams()
SALIENCY = np.linspace(0.05, 0.95, 24, dtype=np.float32).reshape(4, 6)


def joined_logit(network, **values) -> np.ndarray:
    params = MotionNetworkParams(**values)
    joined = join_evidence(SALIENCY, np.full((2, 3), network, np.float32), params, FOREGROUND)
    return motion_logit(joined, FOREGROUND.threshold, FOREGROUND.sharpness)


SEEN = motion_logit(SALIENCY, FOREGROUND.threshold, FOREGROUND.sharpness)


def test_without_a_share_saliency_remains():
    np.testing.assert_allclose(joined_logit(3.0, share=0.0), SEEN, atol=1e-4)


def test_the_logits_are_averaged():
    np.testing.assert_allclose(joined_logit(2.0, share=0.5), 0.5 * SEEN + 1.0, atol=1e-4)


@pytest.mark.parametrize("sign", [-1, 1])
def test_the_network_is_never_certain_alone(sign):
    np.testing.assert_allclose(joined_logit(50.0 * sign, share=0.25, limit=4), 0.75 * SEEN + sign, atol=1e-3)
