// How games are played, as data: pitches, bats, cricket deliveries, bowling balls, oil and deliveries, golf swings
// (chapter 19). Each has its source; the same numbers are files of presets/ (carom/scene/game_presets.h).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "carom/sports/baseball.h"
#include "carom/sports/bowling.h"
#include "carom/sports/cricket.h"
#include "carom/sports/golf_swing.h"
#include "carom/sports/numbers.h"

namespace carom::sports {

template <class T>
struct GamePreset {
  std::string_view name, description, source;
  T value{};
};

/// four_seam, sinker, cutter, slider, sweeper, curveball, changeup, splitter, gyroball, knuckleball (for the ball of
/// that name), of a right-handed pitcher; elevation and azimuth are for `aimed`.
CAROM_API std::span<const GamePreset<Pitch>> pitch_presets();
/// wood, aluminium, composite_free, fungo.
CAROM_API std::span<const GamePreset<Bat>> bat_presets();
/// outswinger, inswinger, reverse_swinger, slower_ball, bouncer, yorker, leg_cutter, off_break, leg_break, googly,
/// top_spinner, arm_ball, of a right-handed bowler to a right-handed batter.
CAROM_API std::span<const GamePreset<CricketDelivery>> cricket_presets();
/// reactive, urethane, plastic, duckpin, candlepin.
CAROM_API std::span<const GamePreset<BowlingBall>> bowling_ball_presets();
/// oil_32ft, oil_40ft, oil_45ft, worn_oil, dry.
CAROM_API std::span<const GamePreset<Lane>> lane_presets();
/// straight, stroker, tweener, cranker, two_handed, backup, spinner, of a right-hander.
CAROM_API std::span<const GamePreset<Delivery>> bowling_presets();
/// textbook, three_link.
CAROM_API std::span<const GamePreset<Swing>> swing_presets();

CAROM_API core::Result<Pitch> pitch_preset(std::string_view name);
CAROM_API core::Result<Bat> bat_preset(std::string_view name);
CAROM_API core::Result<CricketDelivery> cricket_preset(std::string_view name);
CAROM_API core::Result<BowlingBall> bowling_ball_preset(std::string_view name);
CAROM_API core::Result<Lane> lane_preset(std::string_view name);
CAROM_API core::Result<Delivery> bowling_preset(std::string_view name);
CAROM_API core::Result<Swing> swing_preset(std::string_view name);

/// Names and SI units of the numbers of a Pitch, Bat, CricketDelivery, BowlingBall, Lane (without its stretches) or
/// Delivery; the numbers in that order; and one from named numbers, those not named as by default. Errors: an unknown
/// name, a number named twice or that cannot be.
template <class T>
CAROM_API std::span<const NumberName> game_number_names();
template <class T>
CAROM_API std::vector<double> game_numbers(const T& value);
template <class T>
CAROM_API core::Result<T> game_from_numbers(std::span<const Number> numbers);

}  // namespace carom::sports
