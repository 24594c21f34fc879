import pickle

import numpy as np
import pytest
from conftest import look_around

import phasescan


def test_an_unknown_option_names_the_nearest():
    with pytest.raises(phasescan.OptionError, match="no option 'min_confidance'; did you mean 'min_confidence'"):
        phasescan.match(look_around(), look_around(), min_confidance=0.5)
    with pytest.raises(TypeError, match="no option 'candidate' in section 'global'; did you mean 'candidates'"):
        phasescan.match(look_around(), look_around(), global_={"candidate": 5})
    with pytest.raises(ValueError, match="no option 'keyframe_distance'.*keyframe_distance_m"):
        phasescan.Odometry(keyframe_distance=1.0)
    with pytest.raises(phasescan.OptionError, match="batch_nodes"):
        phasescan.Slam(batch_node=3)
    with pytest.raises(phasescan.OptionError, match="speed_mps"):
        phasescan.simulate("flat", speed_mp=3)


def test_options_are_keywords_sections_or_objects():
    made = phasescan.MatchOptions(fast=True, global_={"candidates": 20})
    assert made["match"]["fast"] is True and made["global"]["candidates"] == 20
    assert made == phasescan.MatchOptions({"match": {"fast": True}, "global": {"candidates": 20}})
    assert made == phasescan.MatchOptions(phasescan.MatchOptions(fast=True), candidates=20)
    assert made != phasescan.MatchOptions() and pickle.loads(pickle.dumps(made)) == made
    assert repr(made) == "MatchOptions(match={'fast': True}, global_={'candidates': 20})"
    assert eval(repr(made), {"MatchOptions": phasescan.MatchOptions}) == made
    assert phasescan.Matcher(options=made).options == made


def test_every_option_can_be_set_to_itself_and_is_described():
    for kind in (phasescan.MatchOptions, phasescan.OdometryOptions, phasescan.SlamOptions, phasescan.LocalizeOptions):
        defaults = kind()
        assert kind(defaults.to_dict()) == defaults
        rows = defaults.describe()
        assert all(row["value"] == row["default"] and row["meaning"] for row in rows)
        assert {row["section"] for row in rows} == set(defaults.to_dict())


def test_values_are_what_the_option_wants():
    for wrong in ({"fast": 1}, {"candidates": 2.5}, {"candidates": True}, {"coarse_share": "0.5"}, {"candidates": 2**40}, {"global_": 5}):
        with pytest.raises(ValueError):
            phasescan.MatchOptions(**wrong)
    with pytest.raises(ValueError, match="global.candidates: value 0 is outside"):
        phasescan.MatchOptions(candidates=0)
    with pytest.raises(ValueError, match="did you mean"):
        phasescan.MatchOptions(global_={"rotations": "swep"})
    assert phasescan.MatchOptions(coarse_share=np.float32(0.5), candidates=np.int64(7), fast=np.bool_(True))["global"]["candidates"] == 7


def test_a_name_of_two_sections_asks_which():
    with pytest.raises(phasescan.OptionError, match="stands in sections loops and glass; expected loops="):
        phasescan.SlamOptions(enabled=False)
    assert phasescan.SlamOptions(loops={"enabled": False})["loops"]["enabled"] is False


def test_options_change_the_answer_and_the_next_match_forgets_them():
    before, now = look_around(), look_around(0.25, -0.15, 2.0)
    plain = phasescan.match(before, now, range_max=12.0)
    strict = phasescan.match(before, now, range_max=12.0, min_confidence=1.0)
    assert plain.usable and not strict.usable and strict.pose == plain.pose
    assert phasescan.match(before, now, range_max=12.0).usable
    with pytest.raises(ValueError, match="method: 'globl' .*did you mean 'global'"):
        phasescan.match(before, now, method="globl")
    assert phasescan.match(before, now, method="fft-mh").pose == phasescan.match(before, now).pose
