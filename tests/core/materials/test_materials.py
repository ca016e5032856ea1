"""The library of materials, its files, and the assignment of materials to segments."""

from dataclasses import MISSING, fields, replace
from pathlib import Path

import numpy as np
import pytest

from tangible_core.data import TEXTURES, Material, SegmentMap
from tangible_core.errors import ConfigError, MaterialError, PictureError
from tangible_core.materials.assignment import LADDER, NEUTRAL, assign, find, library, load_library, relative_roughness
from tangible_core.materials.files import VALUES, MaterialBlock, sources_of
from tangible_core.materials.rules import MaterialRule

MUD = "mud: {stiffness_n_per_m: 300, damping_n_s_per_m: 2, static_friction: 0.6, dynamic_friction: 0.5}\n"


def stripes(count: int, size: int = 40) -> SegmentMap:
    """Return upright segments, side by side."""
    return SegmentMap(np.repeat(np.arange(count, dtype=np.int32), size)[None].repeat(size, axis=0))


def checkers(*amplitudes: float, size: int = 40) -> np.ndarray:
    """Return a picture of stripes, each a checkerboard of its amplitude about 0.5."""
    rows, columns = np.indices((size, size * len(amplitudes)))
    return 0.5 + np.where((rows + columns) % 2, 1, -1) * np.repeat(amplitudes, size)


def complaints(tmp_path: Path, text: str) -> list[str]:
    """Return the complaints about a library file, without its folder."""
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError) as error:
        load_library(path)
    return str(error.value).replace(f"{tmp_path}/", "").splitlines()


class TestLibrary:
    def test_measured_values_are_those_of_the_sources(self):
        assert library()["ice"].dynamic_friction == 0.03
        assert library()["ice"].static_friction == 0.1
        middles = {"sand": (0.69, 0.80), "wood": (0.19, 0.25), "rubber": (0.41, 0.61), "cloth": (0.22, 0.37)}
        middles |= {"stone": (0.34, 0.70), "brick": (0.51, 0.63), "metal": (0.24, 0.35), "foam": (0.87, 1.39)}
        middles |= {"carpet": (0.76, 1.11), "leather": (0.36, 0.43)}
        for name, (low, high) in middles.items():
            assert library()[name].dynamic_friction == pytest.approx((low + high) / 2), name
            assert f"{low:.2f} to {high:.2f}" in library()[name].source

    def test_grain_is_speed_over_frequency(self):
        for name, hertz in {"sand": 140, "wood": (137 + 232) / 2, "cloth": (117 + 148) / 2, "metal": 216.5}.items():
            assert library()[name].grain_m == pytest.approx(0.12 / hertz, rel=0.01), name

    @pytest.mark.parametrize("material", library().values(), ids=lambda each: each.name)
    def test_library_material_is_within_a_desktop_device(self, material: Material):
        assert material.stiffness_n_per_m <= (900 if material.roughness_m else 3000)
        assert 0 < material.damping_n_s_per_m <= 5
        assert material.source

    def test_material_names_are_those_of_the_file(self):
        assert all(name == material.name for name, material in library().items())
        others = {"glass", "rubber", "foam", "carpet", "skin", "grass", "water"}
        assert set(library()) == {NEUTRAL, *LADDER, *others}

    @pytest.mark.parametrize("material", library().values(), ids=lambda each: each.name)
    def test_every_value_has_a_source(self, material: Material):
        sources = sources_of(material)
        assert [*sources] == [*VALUES]
        assert all(sources.values())

    def test_every_texture_model_is_used(self):
        assert {each.texture for each in library().values()} == set(TEXTURES)

    def test_neutral_material_has_no_friction_and_no_texture(self):
        plain = library()[NEUTRAL]
        assert (plain.static_friction, plain.dynamic_friction, plain.roughness_m) == (0, 0, 0)

    def test_ladder_runs_from_smooth_to_rough(self):
        roughness = [library()[name].roughness_m for name in LADDER]
        assert roughness == sorted(roughness)
        assert len(set(roughness)) == len(LADDER)

    def test_library_is_read_once_and_read_only(self):
        assert load_library() is library()
        with pytest.raises(TypeError):
            library()["ice"] = library()["sand"]  # type: ignore[index]

    def test_misspelt_material_name_gets_a_suggestion(self):
        with pytest.raises(MaterialError, match=r"'icee' \(did you mean 'ice'\?\); there are plain, ice, glass"):
            find("icee", library())


class TestOwnFile:
    def test_file_adds_a_material(self, tmp_path: Path):
        path = tmp_path / "mine.yaml"
        path.write_text(MUD)
        more = load_library(path)
        assert more["mud"] == Material("mud", 300, 2, 0.6, 0.5, source="guess")
        assert [*more] == [*library(), "mud"]
        assert "mud" not in library()

    def test_file_changes_some_values_of_a_shipped_material(self, tmp_path: Path):
        path = tmp_path / "mine.yaml"
        path.write_text("ice: {stiffness_n_per_m: 1.2e3}\n")
        ice = load_library(path)["ice"]
        source = f"stiffness_n_per_m: mine.yaml; {library()['ice'].source}"
        assert ice == replace(library()["ice"], stiffness_n_per_m=1200.0, source=source)

    def test_file_may_state_a_source_for_each_value(self, tmp_path: Path):
        path = tmp_path / "mine.yaml"
        path.write_text("ice:\n  dynamic_friction: 0.02\n  source:\n    dynamic_friction: my rig\n    others: guess\n")
        assert load_library(path)["ice"].source == "dynamic_friction: my rig; others: guess"

    def test_all_complaints_come_at_once_with_their_places(self, tmp_path: Path):
        text = (
            "ice: {stifness_n_per_m: 3, damping_n_s_per_m: -1}\n"
            "mud:\n  stiffness_n_per_m: .nan\n  grain_m: fine\n  static_friction: yes\n  source: {grain: x}\n"
            "3: {}\n"
            "felt: 3\n"
            "wood: {dynamic_friction: 0.9}\n"
            "glas: {source: 4}\n"
        )
        lines = complaints(tmp_path, text)
        places = ["1:28", "1:7", "3:3", "5:3", "4:3", "6:12", "2:1", "7:1", "8:1", "9:1", "10:8", "10:1"]
        assert [each.split(": ", 1)[0] for each in lines] == [f"mine.yaml:{place}" for place in places]
        assert "ice.damping_n_s_per_m: Input should be greater than or equal to 0, not -1" in lines[0]
        assert "ice.stifness_n_per_m: unknown option (did you mean 'stiffness_n_per_m'?)" in lines[1]
        assert "which is not a property (did you mean 'grain_m'?)" in lines[5]
        assert "dynamic_friction 0.9 is above static_friction 0.26" in lines[9]
        missing = "stiffness_n_per_m, damping_n_s_per_m, static_friction, dynamic_friction are missing"
        assert lines[11].endswith(f"glas: {missing} (did you mean 'glass'?)")

    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("ice: [\n", "mine.yaml:2:1: expected the node content, but found '<stream end>'"),
            ("ice: {}\nice: {}\n", "mine.yaml:2:1: found duplicate key"),
            ("ice:\n\tgrain_m: 1\n", "mine.yaml:2:1: found character '\\t'"),
            ("", "mine.yaml:1:1: a library is a mapping"),
            ("- ice\n", "mine.yaml:1:1: a library is a mapping"),
            ("ice: {stiffness_n_per_m: 0}\n", "mine.yaml:1:7: ice.stiffness_n_per_m: Input should be greater than 0"),
            ("ice: {grain_m: .inf}\n", "mine.yaml:1:7: ice.grain_m: Input should be a finite number, not inf"),
            ("ice: {grain_m: true}\n", "mine.yaml:1:7: ice.grain_m: Input should be a valid number, not True"),
            ("ice: {seed: 1.5}\n", "mine.yaml:1:7: ice.seed: Input should be a valid integer, not 1.5"),
            ("ice: {anisotropy: 2}\n", "mine.yaml:1:7: ice.anisotropy: Input should be less than or equal to 1, not 2"),
            ("ice: {direction_deg: 180}\n", "mine.yaml:1:7: ice.direction_deg: Input should be less than 180, not 180"),
            ("sand: {texture: smooth}\n", "mine.yaml:1:1: material 'sand': texture is smooth and roughness_m 8.8e-05"),
            ("ice: {texture: drag}\n", "mine.yaml:1:1: material 'ice': texture drag needs a drag_n_s_per_m above 0"),
            (
                "plain: {texture: stick-slip}\n",
                "mine.yaml:1:1: material 'plain': texture stick-slip needs a dynamic_fr",
            ),
        ],
    )
    def test_text_that_is_not_a_library_is_refused(self, tmp_path: Path, text: str, complaint: str):
        assert complaints(tmp_path, text)[0].startswith(complaint)

    def test_misspelt_texture_gets_a_suggestion(self, tmp_path: Path):
        (line,) = complaints(tmp_path, "ice: {texture: periodical}\n")
        assert line.startswith("mine.yaml:1:7: ice.texture: Input should be 'smooth', 'periodic', ")
        assert line.endswith("(did you mean 'periodic'?)")

    def test_sources_of_each_value_are_told_apart(self, tmp_path: Path):
        path = tmp_path / "mine.yaml"
        path.write_text(MUD + "ice: {grain_m: 0.002, texture: smooth}\nglass: {source: my rig}\n")
        mine = load_library(path)
        assert set(sources_of(mine["mud"]).values()) == {"guess"}
        assert set(sources_of(mine["glass"]).values()) == {"my rig"}
        ice = sources_of(mine["ice"])
        assert ice["grain_m"] == ice["texture"] == "mine.yaml"
        assert ice["dynamic_friction"] == "physics.info/friction, ice on steel"
        assert ice["stiffness_n_per_m"] == "guess"

    def test_keys_of_a_file_are_the_fields_of_a_material(self):
        assert set(MaterialBlock.model_fields) == {each.name for each in fields(Material)} - {"name"}
        for each in fields(Material):
            if each.default is not MISSING and each.name != "source":
                assert MaterialBlock.model_fields[each.name].default == each.default

    def test_misspelt_file_gets_a_suggestion(self, tmp_path: Path):
        (tmp_path / "mine.yaml").write_text(MUD)
        with pytest.raises(ConfigError, match=r"mime.yaml: there is no such file \(did you mean 'mine.yaml'\?\)"):
            load_library(tmp_path / "mime.yaml")

    def test_file_that_is_not_text_is_refused(self, tmp_path: Path):
        (tmp_path / "mine.yaml").write_bytes(b"\xff\xfe\x00")
        for path in (tmp_path / "mine.yaml", tmp_path):
            with pytest.raises(ConfigError, match="cannot be read as text"):
                load_library(path)


class TestByName:
    def test_each_label_gets_its_material(self):
        assigned = assign(stripes(3), None, {0: "ice", 1: "sand", 2: "ice"}, library())
        assert [each.name for each in assigned.materials] == ["ice", "sand", "ice"]
        assert assigned.reasons == ("segment 1: named ice", "segment 2: named sand", "segment 3: named ice")

    def test_unnamed_label_is_neutral(self):
        assigned = assign(stripes(2), None, {1: "sand"}, library())
        assert [each.name for each in assigned.materials] == ["plain", "sand"]
        assert assigned.reasons[0] == "segment 1: not named -> plain"

    def test_wrong_labels_and_names_are_all_reported(self):
        with pytest.raises(MaterialError) as error:
            assign(stripes(3), None, {0: "icee", 3: "sand", -1: "sand"}, library())
        first, second, third = str(error.value).splitlines()
        assert first.startswith("segment 1: no material is named 'icee' (did you mean 'ice'?)")
        assert second == "no segment has the key 3: the keys of the 3 segments are 0 to 2, and segment 1 is key 0"
        assert third == "no segment has the key -1: the keys of the 3 segments are 0 to 2, and segment 1 is key 0"


class TestByRoughness:
    def test_rougher_segment_gets_the_rougher_material(self):
        picture = checkers(0.3, 0.0, 0.1)
        assigned = assign(stripes(3), picture, "roughness", library())
        assert [each.name for each in assigned.materials] == ["brick", "ice", "wood"]
        spread = picture.std()
        assert assigned.reasons == (
            f"segment 1: number 3 of 3 from smooth to rough ({0.3 / spread * np.sqrt(80 / 81):.3f}) -> brick",
            "segment 2: number 1 of 3 from smooth to rough (0.000) -> ice",
            f"segment 3: number 2 of 3 from smooth to rough ({0.1 / spread * np.sqrt(80 / 81):.3f}) -> wood",
        )

    def test_shadow_does_not_change_the_roughness(self):
        rows, columns = np.indices((60, 120))
        picture = np.where(columns < 60, columns / 60, 0.5 + 0.05 * np.where((rows + columns) % 2, 1, -1))
        assert [each.name for each in assign(stripes(2, 60), picture, "roughness", library()).materials] == [
            "ice",
            "brick",
        ]

    def test_equally_rough_segments_share_a_rank(self):
        assigned = assign(stripes(3), checkers(0.2, 0.0, 0.2), "roughness", library())
        assert [each.name for each in assigned.materials] == ["brick", "ice", "brick"]
        assert "number 2 of 2" in assigned.reasons[0]

    @pytest.mark.parametrize("picture", [checkers(0.2, 0.2), np.zeros((40, 80)), np.full((40, 80, 3), 0.3)])
    def test_single_rank_gives_the_neutral_material(self, picture: np.ndarray):
        assigned = assign(stripes(2), picture, "roughness", library())
        assert [each.name for each in assigned.materials] == [NEUTRAL, NEUTRAL]

    def test_more_segments_than_materials_share_them_in_order(self):
        assigned = assign(stripes(12), checkers(*np.arange(12) / 30), "roughness", library())
        rungs = [LADDER.index(each.name) for each in assigned.materials]
        assert rungs == [0, 1, 1, 2, 3, 4, 4, 5, 6, 7, 7, 8]

    @pytest.mark.parametrize("scale", [1e-20, 1.0, 1e20])
    def test_roughness_ranks_do_not_depend_on_the_scale(self, scale: float):
        picture = checkers(0.05, 0.3, 0.1)
        assert np.array_equal(relative_roughness(stripes(3), picture * scale), relative_roughness(stripes(3), picture))

    def test_roughness_ranks_do_not_depend_on_the_dtype(self):
        eight = np.rint(checkers(0.05, 0.3, 0.1) * 255).astype(np.uint8)
        expected = assign(stripes(3), eight, "roughness", library()).digest()
        colour = np.repeat(eight[..., None], 3, axis=2)
        variants = (eight.astype(np.uint16) * 257, eight / 255, colour, np.dstack([colour, np.full_like(eight, 255)]))
        for variant in variants:
            assert assign(stripes(3), variant, "roughness", library()).digest() == expected

    @pytest.mark.parametrize(("shape", "side"), [((40, 90), 3), ((300, 256), 5), ((704, 800), 11)])
    def test_roughness_window_is_a_64th_of_the_shorter_side(self, shape: tuple[int, int], side: int):
        """Compare with the plain formula: the median of the deviation in windows of at least three pixels."""
        picture = np.random.default_rng(2).random(shape)
        picture[:, shape[1] // 2 :] **= 6
        labels = np.zeros(shape, np.int32)
        labels[:, shape[1] // 2 :] = 1
        grey = np.pad(picture, side // 2, mode="symmetric")
        windows = np.lib.stride_tricks.sliding_window_view(grey, (side, side))
        deviations = windows.std(axis=(2, 3)) / picture.std()
        expected = [np.median(deviations[labels == label]) for label in (0, 1)]
        assert relative_roughness(SegmentMap(labels), picture) == pytest.approx(expected, abs=6e-4)

    def test_roughness_of_a_single_pixel_is_zero(self):
        assigned = assign(SegmentMap(np.zeros((1, 1), np.int32)), np.ones((1, 1)), "roughness", library())
        assert assigned.reasons == ("segment 1: number 1 of 1 from smooth to rough (0.000) -> plain",)

    def test_roughness_without_a_picture_is_refused(self):
        for picture in (None, np.zeros((3, 4))):
            with pytest.raises(MaterialError, match=r"need the picture of the segments, \(40, 80\)"):
                assign(stripes(2), picture, "roughness", library())

    def test_roughness_of_a_picture_with_nan_is_refused(self):
        picture = checkers(0.1, 0.2)
        picture[3, 5] = np.nan
        with pytest.raises(PictureError, match="row 3, column 5"):
            assign(stripes(2), picture, "roughness", library())


QUARTERS = np.uint8([[[90, 140, 200], [120, 85, 50]], [[60, 120, 50], [128, 128, 128]]])
"""Sky, wood, grass, stone: one segment each, in reading order."""


def quarters(side: int = 20) -> tuple[SegmentMap, np.ndarray]:
    labels = np.int32([[0, 1], [2, 3]]).repeat(side, axis=0).repeat(side, axis=1)
    return SegmentMap(labels), QUARTERS.repeat(side, axis=0).repeat(side, axis=1)


def rules(*texts: dict) -> list[MaterialRule]:
    return [MaterialRule.model_validate(each) for each in texts]


class TestByRules:
    def test_first_fitting_rule_wins(self):
        segments, picture = quarters()
        given = rules(
            {"segment": 3, "material": "sand"},
            {"at": [25.4, 0], "material": "ice"},
            {"colour": "brown", "material": "wood"},
            {"colour": "blue", "material": "water"},
            {"segment": 0, "material": "glass"},
        )
        assigned = assign(segments, picture, "rules", library(), given, "leather")
        assert [each.name for each in assigned.materials] == ["water", "ice", "leather", "sand"]
        assert assigned.reasons == (
            "segment 1: rule 4, 100 % of it blue -> water",
            "segment 2: rule 2, at [25.4, 0] -> ice",
            "segment 3: not named -> leather",
            "segment 4: rule 1, named -> sand",
        )

    @pytest.mark.parametrize(
        ("at", "label"), [([19.4, 19.4], 0), ([19.6, 19.4], 1), ([19.4, 19.6], 2), ([39, 39], 3), ([0, 39.4], 2)]
    )
    def test_point_selects_the_pixel_with_the_nearest_centre(self, at: list[float], label: int):
        """Select a pixel; centres are at whole numbers."""
        assigned = assign(quarters()[0], None, "rules", library(), rules({"at": at, "material": "ice"}))
        assert [each.name for each in assigned.materials].index("ice") == label

    def test_rest_is_decided_by_name_or_by_roughness(self):
        given = rules({"segment": 1, "material": "glass"})
        assigned = assign(stripes(3), None, {1: "sand", 2: "wood"}, library(), given)
        assert [each.name for each in assigned.materials] == ["plain", "glass", "wood"]
        picture = checkers(0.3, 0.0, 0.1)
        alone, ruled = (assign(stripes(3), picture, "roughness", library(), each) for each in ([], given))
        assert [each.name for each in ruled.materials] == ["brick", "glass", "wood"]
        assert ruled.reasons[::2] == alone.reasons[::2]

    def test_roughness_needs_no_picture_if_rules_decide_everything(self):
        given = rules(*({"segment": label, "material": "ice"} for label in range(2)))
        assert [each.name for each in assign(stripes(2), None, "roughness", library(), given).materials] == ["ice"] * 2

    def test_colour_rule_follows_most_pixels(self):
        segments, picture = quarters()
        picture[:9, :20] = (200, 30, 30)
        assigned = assign(segments, picture, "rules", library(), rules({"colour": "blue", "material": "water"}))
        assert assigned.reasons[0] == "segment 1: rule 1, 55 % of it blue -> water"
        picture[:11, :20] = (200, 30, 30)
        assigned = assign(segments, picture, "rules", library(), rules({"colour": "blue", "material": "water"}))
        assert assigned.reasons[0] == "segment 1: not named -> plain"

    def test_rule_that_fits_nothing_is_logged(self, caplog: pytest.LogCaptureFixture):
        assign(*quarters(), "rules", library(), rules({"colour": "pink", "material": "skin"}))
        assert caplog.messages == ["materials: rule 1: no segment is pink"]

    @pytest.mark.parametrize("point", [[0, 0], [19.4, 19.4], [-0.0, 0.4]])
    def test_point_counts_in_pixels_of_the_picture(self, point: list):
        assigned = assign(*quarters(), "rules", library(), rules({"at": point, "material": "ice"}))
        assert [each.name for each in assigned.materials] == ["ice", "plain", "plain", "plain"]

    def test_every_wrong_rule_is_reported(self):
        given = rules(
            {"segment": 4, "material": "ice"}, {"at": [40, 3], "material": "ice"}, {"colour": "red", "material": "ice"}
        )
        with pytest.raises(MaterialError) as error:
            assign(quarters()[0], np.zeros((3, 4)), "rules", library(), given)
        first, second, third = str(error.value).splitlines()
        assert first.startswith("materials: rule 1: no segment has the key 4: the keys of the 4 segments are 0 to 3")
        assert second == "materials: rule 2: [40, 3] lies outside the picture of 40 x 40 pixels"
        assert third.startswith("materials: rule 3: a rule by colour needs the segmented picture")

    @pytest.mark.parametrize("rule", [{}, {"segment": 0, "colour": "red"}])
    def test_rule_with_two_selectors_or_none_is_refused(self, rule: dict):
        with pytest.raises(ValueError, match="takes one of segment, part, at and colour"):
            MaterialRule.model_validate({**rule, "material": "ice"})
