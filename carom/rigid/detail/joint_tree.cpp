// The arithmetic of joint_tree.h.
#include "carom/rigid/detail/joint_tree.h"

#include "carom/rigid/detail/joint_law.h"
#include "carom/rigid/detail/joint_rows.h"
#include "carom/rigid/detail/joint_tree_energy.h"
#include "carom/rigid/detail/move_body.h"

namespace carom::rigid::detail {
namespace {

constexpr double trace_of_compliance = 1e-5;     ///< of the row's own mobility
constexpr double correction_share = 0.3;         ///< of an error that a substep removes
constexpr double largest_correction_speed = 10;  ///< m/s and rad/s
constexpr int refinements = 6;                   ///< most Newton steps toward the joint at the end of the substep
constexpr double small_error = 1e-6;             ///< m and rad: no further step
constexpr float far_turn = 0.5f;                 ///< rad in a substep
/// Under tension F a body swings between its joints at up to ω² = F r/I. Positions that follow from velocities bear
/// ω h < 2, and long before that what swings faster than this square gets inertia for it (see `stiffen`).
constexpr double calm_swing = 0.25;
constexpr double swing_damping = 1;     ///< share of that stiffness, per substep, that damps links against each other
constexpr double rod_damping = 0.2;     ///< of a rod's cross motion in the same way: also of its swing as a whole
constexpr double account_share = 1e-3;  ///< of a free tree's energy that its joints may have lost and give back
constexpr int most_drives = 4096;       ///< axes times bodies of a tree whose motors and stops are solved through it
constexpr double tension_decay = 0.8;   ///< a tension is remembered for some substeps, because it may flicker

template <class D>
class Tree {
 public:
  static constexpr int dofs = TreeBody<D>::dofs, dimension = D::dimension, turning = dofs - dimension;
  using Row = double[dofs];

  Tree(StepContext<D>& context, TreeRange& range)
      : context_(context),
        trees_(context.world.joints.trees),
        range_(range),
        energy_{context, context.world.joints.trees, range} {}

  void load_impulses() {
    for (int j = range_.first_joint; j < range_.joint_end; ++j) {
      TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      int row = 0;
      visit_rigid_rows(record_of(joint), BodyPair<D>{},
                       [&](auto, auto, auto, float, float& impulse) { joint.settled[row++] = double(impulse); });
      joint.rigid_rows = joint.rows = row;
      joint.tension = 0;
      note_settled(joint);
    }
  }
  void store_impulses() {
    for (int j = range_.first_joint; j < range_.joint_end; ++j) {
      TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      int row = 0;
      visit_rigid_rows(record_of(joint), BodyPair<D>{},
                       [&](auto, auto, auto, float, float& impulse) { impulse = float(joint.settled[row++]); });
    }
  }

  void factorise() {
    const auto& store = context_.world.bodies;
    for (int i = range_.first_body; i < range_.body_end; ++i) {
      TreeBody<D>& body = trees_.bodies[std::size_t(i)];
      const std::size_t slot = std::size_t(body.body);
      const BodyMotion<D>& motion = store.motion[slot];
      const std::uint8_t locks = store.record[slot].locks;
      for (int r = 0; r < dofs; ++r)
        for (int c = 0; c < dofs; ++c) body.mass[r][c] = 0;
      for (auto& row : body.stiffness)
        for (double& x : row) x = 0;
      const double factor = mass_factor(motion);
      body.own_mass = factor * double(motion.mass);
      body.inverse_mass = double(motion.inverse_mass) / factor;
      for (int k = 0; k < dimension; ++k) body.mass[k][k] = body.own_mass * ((locks >> k & 1) != 0 ? locked_mass : 1);
      fill_inertia(body, motion, context_.bodies[slot].delta_rotation * store.pose[slot].rotation, locks);
    }
    for (int j = range_.first_joint; j < range_.joint_end; ++j) fill_rows(trees_.joints[std::size_t(j)]);
    for (int i = range_.first_body; i < range_.body_end; ++i) stiffen(trees_.bodies[std::size_t(i)]);
    for (int j = range_.closing; j < range_.joint_end; ++j) {
      const TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      TreeBody<D>& child = trees_.bodies[std::size_t(joint.child)];
      for (int k = 0; k < joint.rows; ++k)
        for (int r = 0; r < dofs; ++r) {
          const double x = joint.child_row[k][r] / joint.compliance[k];
          for (int c = 0; c <= r; ++c) child.mass[r][c] += x * joint.child_row[k][c];
        }
    }
    for (int i = range_.body_end - 1; i >= range_.first_body; --i) {
      TreeBody<D>& body = trees_.bodies[std::size_t(i)];
      factorise_block(body.mass, body.inverse, dofs);
      if (body.joint == none) continue;
      TreeJoint<D>& joint = trees_.joints[std::size_t(body.joint)];
      const int rows = joint.rows;
      for (int k = 0; k < rows; ++k) {
        for (int c = 0; c < dofs; ++c) joint.reach[k][c] = joint.child_row[k][c];
        solve_block(body.mass, body.inverse, dofs, joint.reach[k]);
      }
      for (int k = 0; k < rows; ++k) {
        for (int l = 0; l <= k; ++l) joint.pivot[k][l] = inner_product(joint.child_row[k], joint.reach[l]);
        joint.pivot[k][k] += joint.compliance[k];
      }
      factorise_block(joint.pivot, joint.inverse, rows);
      if (joint.parent == none) continue;
      double column[dofs];
      for (int c = 0; c < dofs; ++c) {
        for (int k = 0; k < rows; ++k) column[k] = joint.parent_row[k][c];
        solve_block(joint.pivot, joint.inverse, rows, column);
        for (int k = 0; k < rows; ++k) joint.share[k][c] = column[k];
      }
      TreeBody<D>& parent = trees_.bodies[std::size_t(joint.parent)];
      for (int k = 0; k < rows; ++k)
        for (int r = 0; r < dofs; ++r)
          for (int c = 0; c <= r; ++c) parent.mass[r][c] += joint.parent_row[k][r] * joint.share[k][c];
    }
  }

  /// Where a substep has brought the bodies.
  void follow() {
    factorise();
    if (range_.drives && range_.slender) measure_drives();
  }

  /// How the axes that are driven move, held by the whole tree.
  void measure_drives() {
    int drives = 0;
    for (int j = range_.first_joint; j < range_.joint_end; ++j)
      for_each_block(record_of(trees_.joints[std::size_t(j)]),
                     [&](JointPart, const auto& block) { drives += is_driven<D>(block) ? 1 : 0; });
    range_.drives = drives > 0 && drives * (range_.body_end - range_.first_body) <= most_drives;
    const float h = context_.h;
    for_each_drive(
        [&](TreeJoint<D>& joint, int axis, const Row& child, const Row& parent, float, AxisLaw& law) {
          double own = mobility_of(trees_.bodies[std::size_t(joint.child)], child);
          if (joint.parent != none) own += mobility_of(trees_.bodies[std::size_t(joint.parent)], parent);
          double mobility = own;
          if (range_.drives) {
            record_of(joint).direct = Direct::all;
            push(joint, child, parent, 1);
            respond<false>();
            mobility = inner_product(child, trees_.bodies[std::size_t(joint.child)].load);
            if (joint.parent != none) mobility += inner_product(parent, trees_.bodies[std::size_t(joint.parent)].load);
            joint.axis_mobility[axis] = mobility;
          }
          if (law.has(AxisLaw::spring)) tell_spring(law.response, float(mobility), float(own), h);
        },
        [&](TreeJoint<D>& joint, const BodyPair<D>&, AngularBlock<D>& block) {
          const auto trace = [](const TreeBody<D>& body) {
            double sum = 0;
            for (int i = 0; i < turning; ++i) sum += body.inverse_inertia[i][i];
            return sum;
          };
          double own = trace(trees_.bodies[std::size_t(joint.child)]);
          if (joint.parent != none) own += trace(trees_.bodies[std::size_t(joint.parent)]);
          if (!range_.drives) {
            if (!block.friction) tell_spring(block.response, float(own), float(own), h);
            return;
          }
          record_of(joint).direct = Direct::all;
          double mobility = 0;
          for (int axis = 0; axis < turning; ++axis) {
            Row child = {}, parent = {};
            child[dimension + axis] = 1, parent[dimension + axis] = -1;
            push(joint, child, parent, 1);
            respond<false>();
            double change[turning];
            for (int i = 0; i < turning; ++i) {
              change[i] = trees_.bodies[std::size_t(joint.child)].load[dimension + i];
              if (joint.parent != none) change[i] -= trees_.bodies[std::size_t(joint.parent)].load[dimension + i];
            }
            set_column(joint.turn_mobility, axis, change);
            mobility += change[axis];
          }
          if (!block.friction) tell_spring(block.response, float(mobility), float(own), h);
        });
  }

  /// Where a substep begins, with the impulses of the last one: contacts shall meet a tree that hangs together.
  void begin() {
    for (int j = range_.first_joint; j < range_.joint_end; ++j)
      for (double& x : trees_.joints[std::size_t(j)].impulse) x = 0;
    find_residuals(false);
    clear_loads();
    if (range_.drives) load_drives();
    respond<true>();
  }

  /// Before positions move: the errors at the end of the substep shall be a share of those now.
  void solve_positions() {
    drive(true);
    const float turn = limit_spins();
    const double before = energy_.kinetic();
    // An error of attitude is known up to a whole revolution: what turns far in a substep first agrees on how fast.
    if (turn > far_turn) solve_velocities(false);
    approach();
    const double after = energy_.kinetic();
    range_.work = after - before;
    // Joints that cannot meet pull without end: no more energy than bringing them together may take.
    const double allowed = before + energy_.at_speed(largest_correction_speed);
    if (range_.work > allowed) {
      energy_.take(range_.work - allowed, after);
      range_.work = allowed;
    }
  }
  void solve_velocities(bool damp) {
    find_residuals(damp);
    solve();
  }
  void settle() {
    const double before = energy_.kinetic();
    solve_velocities(true);
    for (int j = range_.first_joint; j < range_.joint_end; ++j) {
      TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      for (int k = 0; k < joint.rigid_rows; ++k) joint.settled[k] = joint.impulse[k];
      note_settled(joint);
    }
    // Joints do no work: what rounding and large turns made of a substep is not to be more than there was.
    double turning = 0;
    const double after = energy_.kinetic(turning);
    range_.work += after - before;
    double excess = range_.work;
    if (range_.free) {
      // Of a tree that spins, what the substeps err swings to and fro with its inner motion: taken out each time that
      // it is above nothing, it would bring that motion to rest. So it counts as a sum, which forgets all but a little.
      const std::int32_t first = trees_.joints[std::size_t(range_.first_joint)].joint;
      float& account = context_.world.joints.at(first).memory.drift;
      excess += double(account);
      account = float(max(min(excess, 0.0), -account_share * (after + turning)));
    }
    if (excess > 0) energy_.take(excess, after);
    drive(false);
  }

 private:
  /// Returns the greatest turn of a body in this substep, rad. Faster ones than may be are slowed.
  float limit_spins() {
    float greatest = 0;
    for (int i = range_.first_body; i < range_.body_end; ++i) {
      SolverBody<D>& body = context_.bodies[trees_.bodies[std::size_t(i)].body];
      const float turn = context_.h * magnitude(body.angular_velocity);
      greatest = max(greatest, turn);
      if (turn > max_turn) body.angular_velocity *= max_turn / turn;
    }
    return greatest;
  }
  /// Calls on_axis(joint, number of its axis, the row of the child, that of the parent, coordinate, law) and
  /// on_turn(joint, turns of its bodies, block).
  template <class OnAxis, class OnTurn>
  void for_each_drive(OnAxis&& on_axis, OnTurn&& on_turn) {
    for (int j = range_.first_joint; j < range_.joint_end; ++j) {
      TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      JointRecord<D>& record = record_of(joint);
      int axis = 0;
      for_each_block(record, [&](JointPart, auto& block) {
        if (!is_driven<D>(block)) return;
        BodyPair<D> pair;
        load_turns(pair, record, context_.bodies);
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(block)>, AngularBlock<D>>)
          return on_turn(joint, pair, block);
        visit_axis<D>(block, pair, [&](auto n, auto lever_a, auto lever_b, float coordinate, AxisLaw& law) {
          Row child, parent;
          const double sign = joint.child_is_b ? 1 : -1;
          fill_row(child, sign, n, joint.child_is_b ? lever_b : lever_a);
          fill_row(parent, -sign, n, joint.child_is_b ? lever_a : lever_b);
          on_axis(joint, axis++, child, parent, coordinate, law);
        });
      });
    }
  }
  void find_residuals(bool damp) {
    for (int j = range_.first_joint; j < range_.joint_end; ++j) {
      TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      double child[dofs], parent[dofs] = {};
      velocity_of(child, context_.bodies[trees_.bodies[std::size_t(joint.child)].body]);
      const JointRecord<D>& record = record_of(joint);
      const std::int32_t other = joint.child_is_b ? record.body_a : record.body_b;
      if (other != none) velocity_of(parent, context_.bodies[other]);
      for (int k = 0; k < joint.rows; ++k)
        joint.residual[k] = (k < joint.rigid_rows ? 1 : (damp ? joint.damping : 0)) *
                            (inner_product(joint.child_row[k], child) + inner_product(joint.parent_row[k], parent));
    }
  }
  /// What motors, springs, friction and stops gave in the last substep, on the bodies.
  void load_drives() {
    for_each_drive(
        [&](TreeJoint<D>& joint, int, const Row& child, const Row& parent, float, AxisLaw& law) {
          if (range_.slender) law.lower_impulse = law.upper_impulse = 0;
          add_load(joint, child, parent, double(law.total()));
        },
        [&](TreeJoint<D>& joint, const BodyPair<D>&, AngularBlock<D>& block) {
          Row child, parent;
          fill_turn(joint, block.impulse, child, parent);
          add_load(joint, child, parent, 1);
        });
  }
  /// Motors, springs, friction and stops, one after the other.
  void drive(bool use_bias) {
    if (!range_.drives) return;
    if (use_bias) solve_velocities(false);  // what contacts did to some is felt by all
    const JointPass pass = joint_pass(context_, use_bias);
    for_each_drive(
        [&](TreeJoint<D>& joint, int axis, const Row& child, const Row& parent, float coordinate, AxisLaw& law) {
          double v[dofs];
          velocity_of(v, context_.bodies[trees_.bodies[std::size_t(joint.child)].body]);
          double speed = inner_product(child, v);
          const JointRecord<D>& record = record_of(joint);
          if (const std::int32_t other = joint.child_is_b ? record.body_a : record.body_b; other != none) {
            velocity_of(v, context_.bodies[other]);
            speed += inner_product(parent, v);
          }
          const float impulse = law.solve(float(joint.axis_mobility[axis]), coordinate, float(speed), pass);
          if (impulse == 0) return;
          push(joint, child, parent, double(impulse));
          respond<true>();
        },
        [&](TreeJoint<D>& joint, BodyPair<D>& pair, AngularBlock<D>& block) {
          const JointRecord<D>& record = record_of(joint);
          if (record.body_a != none) pair.spin_a = context_.bodies[record.body_a].angular_velocity;
          pair.spin_b = context_.bodies[record.body_b].angular_velocity;
          const typename D::Angular impulse = block.solve(pair, joint.turn_mobility, pass);
          Row child, parent;
          fill_turn(joint, impulse, child, parent);
          push(joint, child, parent, 1);
          respond<true>();
        });
  }
  /// Rows of an impulse that turns B.
  static void fill_turn(const TreeJoint<D>& joint, const typename D::Angular& impulse, Row& child, Row& parent) {
    for (int i = 0; i < dofs; ++i) child[i] = parent[i] = 0;
    for (int i = 0; i < turning; ++i) {
      child[dimension + i] = (joint.child_is_b ? 1 : -1) * double(component(impulse, i));
      parent[dimension + i] = -child[dimension + i];
    }
  }
  static float component(float x, int) { return x; }
  static float component(const Vec3f& x, int i) { return x[i]; }
  static void set_column(float& m, int, const double (&column)[1]) { m = float(column[0]); }
  static void set_column(Mat3f& m, int i, const double (&column)[3]) {
    (i == 0 ? m.cx : i == 1 ? m.cy : m.cz) = {float(column[0]), float(column[1]), float(column[2])};
  }
  /// An impulse along a row, for `respond`.
  void push(const TreeJoint<D>& joint, const Row& child, const Row& parent, double impulse) {
    clear_loads();
    for (int j = range_.first_joint; j < range_.joint_end; ++j)
      for (double& x : trees_.joints[std::size_t(j)].residual) x = 0;
    add_load(joint, child, parent, impulse);
  }
  void clear_loads() {
    for (int i = range_.first_body; i < range_.body_end; ++i)
      for (double& x : trees_.bodies[std::size_t(i)].load) x = 0;
  }
  void add_load(const TreeJoint<D>& joint, const Row& child, const Row& parent, double impulse) {
    for (int c = 0; c < dofs; ++c) trees_.bodies[std::size_t(joint.child)].load[c] += child[c] * impulse;
    for (int c = 0; joint.parent != none && c < dofs; ++c)
      trees_.bodies[std::size_t(joint.parent)].load[c] += parent[c] * impulse;
  }
  void approach() {
    for (int pass = 0; pass < refinements; ++pass) {
      look_ahead();
      double worst = 0;
      for (int j = range_.first_joint; j < range_.joint_end; ++j) {
        TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
        JointRecord<D>& record = record_of(joint);
        BodyPair<D> pair;
        pair_ahead(pair, joint, record);
        int k = 0;
        const double inverse_h = double(context_.inverse_h);
        visit_rigid_rows(record, pair, [&](auto, auto, auto, float error, float&) {
          const double correction =
              clamp(correction_share * joint.error[k] * inverse_h, -largest_correction_speed, largest_correction_speed);
          const double miss = (double(error) - joint.error[k]) * inverse_h + correction;
          joint.residual[k] = miss + joint.compliance[k] * joint.impulse[k];
          worst = max(worst, math::abs(joint.residual[k]));
          ++k;
        });
        for (; k < joint.rows; ++k) joint.residual[k] = 0;
      }
      if (pass > 0 && worst < small_error * double(context_.inverse_h)) return;
      solve();
    }
  }
  JointRecord<D>& record_of(const TreeJoint<D>& joint) {
    return *std::launder(reinterpret_cast<JointRecord<D>*>(&context_.world.joints.records[joint.record]));
  }

  void fill_rows(TreeJoint<D>& joint) {
    JointRecord<D>& record = record_of(joint);
    BodyPair<D> pair;
    load_turns(pair, record, context_.bodies);
    const TreeBody<D>& child = trees_.bodies[std::size_t(joint.child)];
    const double sign = joint.child_is_b ? 1 : -1;
    int k = 0;
    visit_rigid_rows(record, pair, [&](auto n, auto lever_a, auto lever_b, float error, float&) {
      fill_row(joint.child_row[k], sign, n, joint.child_is_b ? lever_b : lever_a);
      fill_row(joint.parent_row[k], -sign, n, joint.child_is_b ? lever_a : lever_b);
      joint.error[k] = double(error);
      double mobility = mobility_of(child, joint.child_row[k]);
      if (joint.parent != none) mobility += mobility_of(trees_.bodies[std::size_t(joint.parent)], joint.parent_row[k]);
      joint.compliance[k] = mobility > 0 ? trace_of_compliance * mobility : 1;
      ++k;
    });
    joint.rows = joint.rigid_rows;
    joint.damping = 0;
    note_tension(joint, record, pair);
  }

  // Geometric stiffness. That J turns with the bodies acts like springs of stiffness λ ∂J/∂x; taken explicitly, light
  // links between heavy loads shake themselves apart. They are taken implicitly to first order, ½h² of them beside the
  // mass (after Tournier et al., "Stable constrained dynamics", 2015, and Andrews et al., "Geometric stiffness for
  // real-time constrained multibody dynamics", 2017).
  void note_tension(TreeJoint<D>& joint, JointRecord<D>& record, const BodyPair<D>& pair) {
    for_each_block(record, [&](JointPart, auto& block) {
      using Block = std::remove_cvref_t<decltype(block)>;
      if (!is_rigid(block)) return;
      if constexpr (std::is_same_v<Block, PinBlock<D>>) {
        const double force = joint.tension * double(context_.inverse_h);
        const auto b = rotate(pair.turn_b, block.arm_b), a = block.offset + pair.shift + b;
        add_stiffness(trees_.bodies[std::size_t(joint.child)], joint.child_is_b ? b : a, force);
        if (joint.parent == none) return;
        add_stiffness(trees_.bodies[std::size_t(joint.parent)], joint.child_is_b ? a : b, force);
        add_damping(joint, force * double(math::length(joint.child_is_b ? b : a)));
      } else if constexpr (std::is_same_v<Block, LinearAxis<D>>) {
        if (!block.between_anchors) return;
        const auto row = block.row(pair);
        const double force = joint.tension * double(context_.inverse_h);
        const double stiffness = force / max(double(row.coordinate), 1e-6), h = double(context_.h);
        double inverse_mass = trees_.bodies[std::size_t(joint.child)].inverse_mass;
        if (joint.parent != none) inverse_mass += trees_.bodies[std::size_t(joint.parent)].inverse_mass;
        const double swing = 2 * stiffness * inverse_mass * h * h;
        if (swing > calm_swing) add_cross_rows(joint, row.n, 1 / (0.5 * h * h * stiffness * (1 - calm_swing / swing)));
      }
    });
  }
  void note_settled(TreeJoint<D>& joint) {
    // The rows along directions come last: two or three of a pin, the one of a rod.
    double squared = 0;
    for (int k = max(0, joint.rigid_rows - dimension); k < joint.rigid_rows; ++k)
      squared += joint.settled[k] * joint.settled[k];
    joint.tension = max(math::sqrt(squared), tension_decay * joint.tension);
  }
  /// Links that swing against each other faster than the substeps can follow are damped, both alike.
  void add_damping(TreeJoint<D>& joint, double stiffness) {
    const double h = double(context_.h), swing = h * h * stiffness;
    const TreeBody<D>& child = trees_.bodies[std::size_t(joint.child)];
    double inertia = 0;
    for (int i = 0; i < turning; ++i) inertia += child.inertia[i][i];
    if (joint.rows + turning > dofs || !(swing * turning > 0.1 * inertia)) return;
    joint.damping = 1;
    for (int i = 0; i < turning; ++i) {
      const int k = joint.rows++;
      for (int c = 0; c < dofs; ++c) {
        joint.child_row[k][c] = c == dimension + i ? 1 : 0;
        joint.parent_row[k][c] = c == dimension + i ? -1 : 0;
      }
      joint.compliance[k] = 1 / (swing_damping * swing);
      joint.impulse[k] = 0;
    }
  }
  static void add_stiffness(TreeBody<Dim2>& body, Vec2f arm, double force) {
    body.stiffness[0][0] += force * double(math::length(arm));
  }
  /// |F||r| about the axes across r.
  static void add_stiffness(TreeBody<Dim3>& body, Vec3f arm, double force) {
    const double length = double(math::length(arm));
    if (!(length > 0)) return;
    const double scale = force / length;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        body.stiffness[i][k] += scale * ((i == k ? length * length : 0) - double(arm[i]) * double(arm[k]));
  }
  /// Rows that resist a rod's swing: they remember nothing.
  static void add_cross_rows(TreeJoint<D>& joint, typename D::Vector n, double compliance) {
    typename D::Vector across[D::dimension - 1];
    if constexpr (D::dimension == 2) {
      across[0] = {-n.y, n.x};
    } else {
      across[0] = normalize(cross(n, math::abs(n.x) < 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0}));
      across[1] = cross(n, across[0]);
    }
    joint.damping = rod_damping;
    for (const auto& direction : across) {
      const int k = joint.rows++;
      fill_row(joint.child_row[k], 1, direction, {});
      fill_row(joint.parent_row[k], -1, direction, {});
      joint.compliance[k] = compliance;
      joint.impulse[k] = 0;
    }
  }
  void stiffen(TreeBody<D>& body) const {
    double trace = 0, product = 0;  // of K, of K I
    for (int i = 0; i < turning; ++i) {
      trace += body.stiffness[i][i];
      for (int k = 0; k < turning; ++k) product += body.stiffness[i][k] * body.mass[dimension + i][dimension + k];
    }
    const double h = double(context_.h), swing = trace * trace * h * h * (dimension == 3 ? 0.5 : 1.0);
    if (!(swing > calm_swing * product)) return;
    const double scale = 0.5 * h * h * (1 - calm_swing * product / swing);
    for (int i = 0; i < turning; ++i)
      for (int k = 0; k < turning; ++k) body.mass[dimension + i][dimension + k] += scale * body.stiffness[i][k];
  }
  static double mobility_of(const TreeBody<D>& body, const double (&row)[dofs]) {
    double sum = 0;
    for (int c = 0; c < dimension; ++c) sum += row[c] * row[c];
    sum *= body.inverse_mass;
    for (int r = dimension; r < dofs; ++r)
      for (int c = dimension; c < dofs; ++c)
        sum += row[r] * body.inverse_inertia[r - dimension][c - dimension] * row[c];
    return sum;
  }

  SolverBody<D> moved(std::int32_t slot) const {
    const auto& store = context_.world.bodies;
    SolverBody<D> s = context_.bodies[slot];
    const BodyRecord& record = store.record[std::size_t(slot)];
    if (record.type == BodyType::fixed) return s;
    const BodyMotion<D>& m = store.motion[std::size_t(slot)];
    s.delta_position += context_.h * s.linear_velocity;
    if (may_turn_freely(m, record) && spins(s.angular_velocity))
      turn_pushed(s, m, store.pose[std::size_t(slot)].rotation, context_.h);
    else
      turn_body(s, context_.h);
    return s;
  }
  void look_ahead() {
    for (int i = range_.first_body; i < range_.body_end; ++i) {
      TreeBody<D>& body = trees_.bodies[std::size_t(i)];
      body.ahead = moved(body.body);
    }
  }
  void pair_ahead(BodyPair<D>& pair, const TreeJoint<D>& joint, const JointRecord<D>& record) const {
    const std::int32_t other_slot = joint.child_is_b ? record.body_a : record.body_b;
    const SolverBody<D>& child = trees_.bodies[std::size_t(joint.child)].ahead;
    const SolverBody<D> other = joint.parent != none ? trees_.bodies[std::size_t(joint.parent)].ahead
                                                     : (other_slot != none ? moved(other_slot) : SolverBody<D>{});
    const SolverBody<D>&a = joint.child_is_b ? other : child, &b = joint.child_is_b ? child : other;
    pair.turn_a = a.delta_rotation;
    pair.turn_b = b.delta_rotation;
    pair.shift = b.delta_position - a.delta_position;
  }

  /// Solves for the residuals of the joints; adds to impulses and velocities.
  void solve() {
    clear_loads();
    respond<true>();
  }
  /// What impulses on the bodies (their `load`) and the residuals change. Not `to_bodies`: only tells it, in `load`.
  template <bool to_bodies>
  void respond() {
    for (int j = range_.closing; j < range_.joint_end; ++j) {
      TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      double* const load = trees_.bodies[std::size_t(joint.child)].load;
      for (int k = 0; k < joint.rows; ++k)
        for (int c = 0; c < dofs; ++c) load[c] -= joint.child_row[k][c] * (joint.residual[k] / joint.compliance[k]);
    }
    for (int i = range_.body_end - 1; i >= range_.first_body; --i) {
      TreeBody<D>& body = trees_.bodies[std::size_t(i)];
      if (body.joint == none) continue;
      TreeJoint<D>& joint = trees_.joints[std::size_t(body.joint)];
      for (int k = 0; k < joint.rows; ++k) joint.residual[k] += inner_product(joint.reach[k], body.load);
      solve_block(joint.pivot, joint.inverse, joint.rows, joint.residual);
      if (joint.parent == none) continue;
      double* const load = trees_.bodies[std::size_t(joint.parent)].load;
      for (int k = 0; k < joint.rows; ++k)
        for (int c = 0; c < dofs; ++c) load[c] -= joint.parent_row[k][c] * joint.residual[k];
    }
    for (int i = range_.first_body; i < range_.body_end; ++i) {
      TreeBody<D>& body = trees_.bodies[std::size_t(i)];
      solve_block(body.mass, body.inverse, dofs, body.load);
      if (body.joint != none) {
        TreeJoint<D>& joint = trees_.joints[std::size_t(body.joint)];
        for (int k = 0; k < joint.rows; ++k) {
          double change = -joint.residual[k];
          if (joint.parent != none)
            change -= inner_product(joint.share[k], trees_.bodies[std::size_t(joint.parent)].load);
          if (to_bodies) joint.impulse[k] += change;
          for (int c = 0; c < dofs; ++c) body.load[c] += joint.reach[k][c] * change;
        }
      }
      if (to_bodies) add_velocity(context_.bodies[body.body], body.load);
    }
    if (!to_bodies) return;
    for (int j = range_.closing; j < range_.joint_end; ++j) {
      TreeJoint<D>& joint = trees_.joints[std::size_t(j)];
      const TreeBody<D>& child = trees_.bodies[std::size_t(joint.child)];
      for (int k = 0; k < joint.rows; ++k)
        joint.impulse[k] -= (joint.residual[k] + inner_product(joint.child_row[k], child.load)) / joint.compliance[k];
    }
  }

  StepContext<D>& context_;
  JointTrees<D>& trees_;
  TreeRange& range_;
  TreeEnergy<D> energy_;
};

template <class D, class F>
void for_each_tree(StepContext<D>& context, F&& f) {
  JointTrees<D>& trees = context.world.joints.trees;
  context.scheduler.parallel_for(int(trees.trees.size()), tree_grain(trees), [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      Tree<D> tree(context, trees.trees[std::size_t(i)]);
      f(tree);
    }
  });
}

}  // namespace

template <class D>
void prepare_trees(StepContext<D>& context) {
  for_each_tree(context, [](Tree<D>& tree) {
    tree.load_impulses();
    tree.factorise();
    tree.measure_drives();
  });
}
template <class D>
void run_trees(StepContext<D>& context, SolverPass pass, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    Tree<D> tree(context, context.world.joints.trees.trees[std::size_t(i)]);
    if (pass == SolverPass::begin_trees)
      tree.begin();
    else if (pass == SolverPass::solve_trees)
      tree.solve_positions();
    else if (pass == SolverPass::factorise_trees)
      tree.follow();
    else
      tree.settle();
  }
}
template <class D>
void store_trees(StepContext<D>& context) {
  for_each_tree(context, [](Tree<D>& tree) { tree.store_impulses(); });
}

template void prepare_trees(StepContext<Dim2>&);
template void prepare_trees(StepContext<Dim3>&);
template void run_trees(StepContext<Dim2>&, SolverPass, int, int);
template void run_trees(StepContext<Dim3>&, SolverPass, int, int);
template void store_trees(StepContext<Dim2>&);
template void store_trees(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
