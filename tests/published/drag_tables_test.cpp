// The drag tables of section 2.1 and the aerodynamic deck of section 2.5 of the shared reference "ballistics", number
// by number: BRL's G1, G7 and GS, two measured projectiles, and the M107. Exact: they are read, not computed.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "carom/ballistics/flight.h"
#include "carom/ballistics/shell.h"

namespace published_drag_tables_test {
using namespace carom;
using namespace carom::ballistics;

constexpr DragPoint g1[] = {
    {0, .2629},     {0.05, .2558},  {0.1, .2487},   {0.15, .2413},  {0.2, .2344},   {0.25, .2278},  {0.3, .2214},
    {0.35, .2155},  {0.4, .2104},   {0.45, .2061},  {0.5, .2032},   {0.55, .2020},  {0.6, .2034},   {0.7, .2165},
    {0.725, .2230}, {0.75, .2313},  {0.775, .2417}, {0.8, .2546},   {0.825, .2706}, {0.85, .2901},  {0.875, .3136},
    {0.9, .3415},   {0.925, .3734}, {0.95, .4084},  {0.975, .4448}, {1, .4805},     {1.025, .5136}, {1.05, .5427},
    {1.075, .5677}, {1.1, .5883},   {1.125, .6053}, {1.15, .6191},  {1.2, .6393},   {1.25, .6518},  {1.3, .6589},
    {1.35, .6621},  {1.4, .6625},   {1.45, .6607},  {1.5, .6573},   {1.55, .6528},  {1.6, .6474},   {1.65, .6413},
    {1.7, .6347},   {1.75, .6280},  {1.8, .6210},   {1.85, .6141},  {1.9, .6072},   {1.95, .6003},  {2, .5934},
    {2.05, .5867},  {2.1, .5804},   {2.15, .5743},  {2.2, .5685},   {2.25, .5630},  {2.3, .5577},   {2.35, .5527},
    {2.4, .5481},   {2.45, .5438},  {2.5, .5397},   {2.6, .5325},   {2.7, .5264},   {2.8, .5211},   {2.9, .5168},
    {3, .5133},     {3.1, .5105},   {3.2, .5084},   {3.3, .5067},   {3.4, .5054},   {3.5, .5040},   {3.6, .5030},
    {3.7, .5022},   {3.8, .5016},   {3.9, .5010},   {4, .5006},     {4.2, .4998},   {4.4, .4995},   {4.6, .4992},
    {4.8, .4990},   {5, .4988}};
constexpr DragPoint g7[] = {
    {0, .1198},     {0.05, .1197},  {0.1, .1196},   {0.15, .1194},  {0.2, .1193},   {0.25, .1194},  {0.3, .1194},
    {0.35, .1194},  {0.4, .1193},   {0.45, .1193},  {0.5, .1194},   {0.55, .1193},  {0.6, .1194},   {0.65, .1197},
    {0.7, .1202},   {0.725, .1207}, {0.75, .1215},  {0.775, .1226}, {0.8, .1242},   {0.825, .1266}, {0.85, .1306},
    {0.875, .1368}, {0.9, .1464},   {0.925, .1660}, {0.95, .2054},  {0.975, .2993}, {1, .3803},     {1.025, .4015},
    {1.05, .4043},  {1.075, .4034}, {1.1, .4014},   {1.125, .3987}, {1.15, .3955},  {1.2, .3884},   {1.25, .3810},
    {1.3, .3732},   {1.35, .3657},  {1.4, .3580},   {1.5, .3440},   {1.55, .3376},  {1.6, .3315},   {1.65, .3260},
    {1.7, .3209},   {1.75, .3160},  {1.8, .3117},   {1.85, .3078},  {1.9, .3042},   {1.95, .3010},  {2, .2980},
    {2.05, .2951},  {2.1, .2922},   {2.15, .2892},  {2.2, .2864},   {2.25, .2835},  {2.3, .2807},   {2.35, .2779},
    {2.4, .2752},   {2.45, .2725},  {2.5, .2697},   {2.55, .2670},  {2.6, .2643},   {2.65, .2615},  {2.7, .2588},
    {2.75, .2561},  {2.8, .2533},   {2.85, .2506},  {2.9, .2479},   {2.95, .2451},  {3, .2424},     {3.1, .2368},
    {3.2, .2313},   {3.3, .2258},   {3.4, .2205},   {3.5, .2154},   {3.6, .2106},   {3.7, .2060},   {3.8, .2017},
    {3.9, .1975},   {4, .1935},     {4.2, .1861},   {4.4, .1793},   {4.6, .1730},   {4.8, .1672},   {5, .1618}};
constexpr DragPoint gs[] = {
    {0, .4662},    {0.05, .4689}, {0.1, .4717},  {0.15, .4745}, {0.2, .4772},  {0.25, .4800}, {0.3, .4827},
    {0.35, .4852}, {0.4, .4882},  {0.45, .4920}, {0.5, .4970},  {0.55, .5080}, {0.6, .5260},  {0.65, .5590},
    {0.7, .5920},  {0.75, .6258}, {0.8, .6610},  {0.85, .6985}, {0.9, .7370},  {0.95, .7757}, {1, .8140},
    {1.05, .8512}, {1.1, .8870},  {1.15, .9210}, {1.2, .9510},  {1.25, .9740}, {1.3, .9910},  {1.35, .9990},
    {1.4, 1.0030}, {1.5, 1.0080}, {1.6, 1.0090}, {1.7, 1.0090}, {1.8, 1.0070}, {1.9, 1.0040}, {2, 1.0010},
    {2.1, .9970},  {2.2, .9940},  {2.3, .9890},  {2.4, .9850},  {2.5, .9810},  {2.6, .9770},  {2.7, .9730},
    {2.8, .9690},  {2.9, .9650},  {3, .9610},    {3.1, .9570},  {3.2, .9540},  {3.3, .9500},  {3.4, .9470},
    {3.5, .9430},  {3.6, .9400},  {3.7, .9370},  {3.8, .9340},  {3.9, .9310},  {4, .9280}};

void expect_nodes(DragFunction function, std::span<const DragPoint> printed, bool all) {
  const std::span<const DragPoint> table = drag_table(function);
  if (all) ASSERT_EQ(table.size(), printed.size()) << to_string(function);
  std::size_t i = 0;
  for (const DragPoint& p : printed) {
    while (i < table.size() && table[i].mach < p.mach) ++i;
    ASSERT_LT(i, table.size()) << to_string(function) << " at M " << p.mach;
    EXPECT_EQ(table[i].mach, p.mach) << to_string(function);
    EXPECT_EQ(table[i].coefficient, p.coefficient) << to_string(function) << " at M " << p.mach;
  }
}

TEST(DragTables, BallisticResearchLaboratory) {
  expect_nodes(DragFunction::g1, g1, true);
  expect_nodes(DragFunction::g7, g7, true);
  expect_nodes(DragFunction::gs, gs, false);  // as printed: every second node above M 1.4
  const std::pair<DragFunction, std::size_t> nodes[] = {
      {DragFunction::g1, 79}, {DragFunction::g2, 85}, {DragFunction::g5, 76}, {DragFunction::g6, 79},
      {DragFunction::g7, 84}, {DragFunction::g8, 78}, {DragFunction::gi, 81}, {DragFunction::ra4, 87}};
  for (const auto& [function, count] : nodes) EXPECT_EQ(drag_table(function).size(), count) << to_string(function);
}

// Sums over the nodes of the tables as they are published (public domain, BRL and the Army's; taken from another
// program's copy on 2026-11-27): of C_D, and of M C_D, which tells order and places as well.
TEST(DragTables, SumsOfAllNine) {
  const struct {
    DragFunction function;
    double drag, moment;
  } rows[] = {{DragFunction::g1, 37.0571, 74.8406675}, {DragFunction::g2, 22.3643, 39.8265675},
              {DragFunction::g5, 22.6479, 43.8116325}, {DragFunction::g6, 23.4477, 39.9214075},
              {DragFunction::g7, 20.0187, 38.6206600}, {DragFunction::g8, 22.0896, 38.5244100},
              {DragFunction::gi, 37.4735, 73.9993575}, {DragFunction::gs, 69.8967, 152.5250850},
              {DragFunction::ra4, 38.8415, 68.5261450}};
  for (const auto& row : rows) {
    double drag = 0, moment = 0;
    for (const DragPoint& p : drag_table(row.function)) drag += p.coefficient, moment += p.mach * p.coefficient;
    EXPECT_NEAR(drag, row.drag, 1e-9) << to_string(row.function);
    EXPECT_NEAR(moment, row.moment, 1e-9) << to_string(row.function);
  }
}

// a = ρ v² C_D (π/8)(0.0254²/0.45359237)/BC, with BC in lb/in².
TEST(DragTables, TheCoefficientIsPoundsPerSquareInch) {
  const Projectile bullet = projectile_from_coefficient(DragFunction::g7, .218);
  const double expected = math::pi / 4 * .0254 * .0254 / .45359237 / .218;
  EXPECT_NEAR(bullet.area_per_mass, expected, 1e-12 * expected);
  // A shell of 2 lb and 1.65 in has a sectional density of .735 (section 2.6).
  const Projectile shell = projectile_from_size(DragCurve(DragFunction::g1), 2 * .45359237, 1.65 * .0254);
  EXPECT_NEAR(shell.area_per_mass, math::pi / 4 * .0254 * .0254 / .45359237 / .735, 1e-3 * shell.area_per_mass);
}

DragCurve preset(const std::string& name) {
  std::ifstream file(std::string(CAROM_SOURCE_DIR) + "/presets/drag/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  const auto curve = read_drag_table(text.str(), name, Interpolation::linear);
  EXPECT_TRUE(curve) << curve.error().message;
  return curve ? *curve : DragCurve();
}

TEST(DragTables, MeasuredProjectiles) {
  const DragCurve match = preset("308_168_smk.txt");
  const DragPoint mccoy[] = {{0, .14},    {.8, .14},    {.85, .142}, {.9, .16},   {.95, .24},
                             {1, .43},    {1.05, .449}, {1.1, .447}, {1.2, .434}, {1.4, .41},
                             {1.6, .385}, {1.8, .365},  {2, .35},    {2.2, .339}, {2.5, .32}};
  for (const DragPoint& p : mccoy) EXPECT_NEAR(match(p.mach), p.coefficient, 1e-15) << p.mach;
  const DragCurve mortar = preset("120mm_mortar.txt");
  const DragPoint measured[] = {{0, .119}, {.7, .119}, {.85, .12}, {.87, .122}, {.9, .126}, {.93, .148}, {.95, .182}};
  for (const DragPoint& p : measured) EXPECT_NEAR(mortar(p.mach), p.coefficient, 1e-15) << p.mach;
  // 13.585 kg and .11956 m: 1 m² of front per so much mass is what its preset flies by.
  std::ifstream file(std::string(CAROM_SOURCE_DIR) + "/presets/projectile/120mm_mortar.json");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find("\"13.585 kg\""), std::string::npos);
  EXPECT_NE(text.str().find("\"119.56 mm\""), std::string::npos);
}

// Per radian, rate derivatives with p d/2V. BRL MR-1582 and NPS AD1029824.
TEST(DragTables, DeckOfTheM107) {
  const Shell shell = m107();
  EXPECT_NEAR(shell.mass, 95.8 * .45359237, 1e-3);
  EXPECT_EQ(shell.mass, 43.4545);
  EXPECT_EQ(shell.diameter, .155);
  EXPECT_EQ(shell.axial_inertia, .14705);
  EXPECT_EQ(shell.transverse_inertia, 1.28888);
  EXPECT_EQ(shell.twist, 20);
  const ShellCoefficients printed[] = {
      {0, .144, 2.343, 1.763, -.767, -.023, 3.355, -5.1, -.500},
      {.6, .144, 2.343, 1.763, -.767, -.023, 3.378, -5.1, -.500},
      {.8, .146, 2.847, 1.783, -.767, -.022, 3.571, -5.1, -.355},
      {.9, .167, 3.372, 1.827, -.857, -.021, 3.957, -7.4, -.112},
      {.95, .221, 3.730, 2.038, -1.082, -.020, 3.886, -9.9, .085},
      {1, .327, 4.180, 2.153, -.992, -.020, 3.682, -13.8, .198},
      {1.05, .383, 4.691, 2.207, -.902, -.020, 3.415, -13.3, .293},
      {1.1, .381, 5.209, 2.255, -.857, -.019, 3.384, -14.6, .334},
      {1.2, .370, 5.702, 2.325, -.767, -.020, 3.424, -15.8, .352},
      {1.35, .353, 5.130, 2.442, -.767, -.020, 3.278, -15.6, .366},
      {1.5, .338, 4.561, 2.556, -.767, -.020, 3.264, -15.3, .373},
      {1.75, .314, 3.970, 2.692, -.767, -.020, 3.201, -15.3, .381},
      {2, .294, 3.460, 2.747, -.767, -.021, 3.013, -15.3, .388},
  };
  for (const ShellCoefficients& p : printed) {
    const ShellCoefficients* found = nullptr;
    for (const ShellCoefficients& row : shell.aerodynamics)
      if (row.mach == p.mach) found = &row;
    ASSERT_NE(found, nullptr) << p.mach;
    const double read[] = {found->axial,        found->axial_yaw,   found->normal,        found->magnus_force,
                           found->roll_damping, found->overturning, found->pitch_damping, found->magnus_moment};
    const double expected[] = {p.axial,        p.axial_yaw,   p.normal,        p.magnus_force,
                               p.roll_damping, p.overturning, p.pitch_damping, p.magnus_moment};
    for (int i = 0; i < 8; ++i) EXPECT_EQ(read[i], expected[i]) << "M " << p.mach << ", column " << i;
  }
}

}  // namespace published_drag_tables_test
