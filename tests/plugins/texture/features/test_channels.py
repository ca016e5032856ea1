"""The channels in which boundaries are detected."""

import numpy as np
import pytest

from tangible_texture.features.channels import channels


class TestChannels:
    def test_grey_in_any_form_is_one_channel(self):
        grey = np.random.default_rng(0).integers(0, 256, (5, 7), np.uint8)
        expected = channels(grey, colour=True)
        assert expected.shape == (5, 7, 1)
        assert expected.max() == 1
        assert np.array_equal(channels(np.repeat(grey[..., None], 3, axis=2), colour=True), expected)

    def test_channels_of_any_type_have_the_same_bits(self):
        eight = np.random.default_rng(0).integers(0, 256, (5, 7, 3), np.uint8)
        expected = channels(eight, colour=True)
        assert expected.shape == (5, 7, 3)
        opaque = np.dstack([eight, np.full((5, 7), 255, np.uint8)])
        for same in (eight.astype(np.uint16) * 257, eight / 255, np.asarray(eight / 255, np.float32), opaque):
            assert np.array_equal(channels(same, colour=True), expected)

    @pytest.mark.parametrize("scale", [1e-20, 1e20, 1e300])
    def test_channels_of_any_scale_have_a_maximum_of_one(self, scale: float):
        picture = np.random.default_rng(0).random((5, 7, 3))
        assert np.allclose(channels(picture * scale, colour=True), picture / picture.max(), rtol=1e-6)

    def test_transparency_lies_over_white(self):
        clear = np.array([[[0, 0, 0, 0], [0, 0, 255, 255]]], np.uint8)
        assert channels(clear, colour=True).tolist() == [[[1, 1, 1], [0, 0, 1]]]

    @pytest.mark.parametrize("channel", [0, 1, 2])
    def test_picture_whose_one_channel_differs_has_colour(self, channel: int):
        picture = np.full((2, 3, 3), 100, np.uint8)
        picture[0, 1, channel] = 101
        assert channels(picture, colour=True).shape == (2, 3, 3)
        assert channels(picture, colour=False).shape == (2, 3, 1)

    def test_picture_of_negative_values_is_scaled_by_the_most_negative(self):
        assert channels(np.array([[-4.0, 1.0, 2.0]]), colour=True)[0, :, 0].tolist() == [-1, 0.25, 0.5]
