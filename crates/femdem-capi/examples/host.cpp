// The three layers from C++: a pair, 500 bodies with the host's own integrator, worlds of rigid, bonded and deformable bodies.
// Numbers are checked; the program ends with 1 if one is wrong.
#include <femdem.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

namespace {

void expect(bool right, const char *what) {
    if (!right) {
        throw std::runtime_error(std::string("wrong: ") + what);
    }
}

// Two cubes of side 1 m, 1 mm into each other.
void pair() {
    femdem::Shape cube("cube", std::sqrt(3.0));
    expect(std::abs(cube.properties().volume - 1.0) < 1e-12, "volume of the cube");
    FemdemPair touch = femdem::pair(1e6, cube, femdem::at(0, 0, 0), cube, femdem::at(0, 0, 0.999));
    // p a delta (1/h_A + 1/h_B) with h = 0.5 m, less the rim.
    expect(std::abs(touch.on_b.force[2] / 4000.0 - 1.0) < 0.003, "force of the pair");
    expect(touch.on_a.force[2] == -touch.on_b.force[2], "action and reaction");
    expect(std::abs(touch.volume - 1e-3) < 1e-12 && touch.patches == 1, "volume of the overlap");
    std::printf("pair: %.3f N\n", touch.on_b.force[2]);
}

// 500 balls in a closed box without gravity, friction and damping, moved by leapfrog: energy is conserved. Balls have no
// rotation to speak of without friction; see femdem_shape_properties for the inertia of other bodies.
void batch() {
    const double radius = 0.05, density = 2500.0, dt = 2e-5;
    femdem::Shape ball("sphere", 2 * radius);
    FemdemLaw law = femdem::default_law();
    law.penalty = 1e7;
    law.friction = 0.0;
    law.damping_ratio = 0.0;
    femdem::Batch batch(law);
    std::vector<FemdemMotion> motions;
    for (int k = 0; k < 500; ++k) {
        const double x = 0.12 * (k % 10) + 0.06, y = 0.12 * (k / 10 % 10) + 0.06, z = 0.12 * (k / 100) + 0.06;
        FemdemVelocity velocity{{std::sin(k), std::cos(k), std::sin(2.0 * k)}, {0, 0, 0}};
        motions.push_back({femdem::at(x, y, z), velocity});
        batch.add_body(ball, density);
    }
    batch.add_box({{0, 0, 0}, {1.2, 1.2, 0.6}});
    const double mass = density * ball.properties().volume;
    auto kinetic = [&] {
        double sum = 0;
        for (const FemdemMotion &motion : motions) {
            for (double v : motion.velocity.linear) {
                sum += 0.5 * mass * v * v;
            }
        }
        return sum;
    };
    std::vector<FemdemLoad> loads;
    batch.update(motions, 0.0, loads);
    auto kick = [&](double time) {
        for (std::size_t k = 0; k < motions.size(); ++k) {
            for (int i = 0; i < 3; ++i) {
                motions[k].velocity.linear[i] += loads[k].force[i] / mass * time;
            }
        }
    };
    const double start = kinetic() + batch.totals().energy;
    std::size_t touching = 0;
    for (int step = 0; step < 1000; ++step) {
        kick(0.5 * dt);
        for (FemdemMotion &motion : motions) {
            for (int i = 0; i < 3; ++i) {
                motion.pose.position[i] += motion.velocity.linear[i] * dt;
            }
        }
        batch.update(motions, dt, loads);
        kick(0.5 * dt);
        touching = std::max(touching, batch.totals().touching);
    }
    FemdemBatchTotals totals = batch.totals();
    const double error = (kinetic() + totals.energy) / start - 1.0;
    std::printf("batch: %zu bodies, up to %zu pairs in touch, energy %.4f J to %.1e\n", motions.size(), touching, start, error);
    expect(touching > 20, "bodies collide");
    expect(std::abs(error) < 1e-4, "energy of the batch");
}

// A cube of 2 kg falls by 10 mm onto a floor and comes to rest; then the same again from the middle.
void world() {
    FemdemWorldParameters parameters = femdem::default_parameters();
    parameters.safety = 0.3;
    femdem::World world(parameters);
    femdem::check(femdem_world_set_threads(world, 2));
    uint32_t floor = world.add_plane({{0, 0, 1}, 0});
    femdem::Shape cube("cube", 0.1 * std::sqrt(3.0));
    uint32_t body = world.add_body(cube, 2000.0, {femdem::at(0, 0, 0.06), {}});
    world.step_until(0.1);
    std::vector<uint8_t> middle = world.to_bytes();
    world.step_until(0.5);
    femdem::World again(middle);
    again.step_until(0.5);
    expect(again.hash() == world.hash(), "the same bits from the middle");

    const double height = world.motions().at(0).pose.position[2];
    expect(world.bodies().at(0) == body && height > 0.0499 && height < 0.05, "the cube lies on the floor");
    FemdemLoad load;
    femdem::check(femdem_world_wall_load(world, floor, &load));
    expect(std::abs(load.force[2] / (-2.0 * 9.81) - 1.0) < 0.02, "the floor bears the weight");
    expect(std::abs(world.ledger().error_relative) < 0.01, "energy of the world");
    expect(world.contacts().size() == 1 && world.contacts()[0].a_is_wall == 1, "one contact");
    std::printf("world: at rest at %.6f m, the floor bears %.3f N\n", height, -load.force[2]);
}

// A ball glued to one that is held hangs by its weight.
void bond() {
    FemdemWorldParameters parameters = femdem::default_parameters();
    parameters.sleeping = 0;
    femdem::World world(parameters);
    femdem::Shape ball("sphere", 0.1);
    uint32_t held = world.add_body(ball, 2500.0, {femdem::at(0, 0, 0), {}});
    uint32_t hung = world.add_body(ball, 2500.0, {femdem::at(0.1, 0, 0), {}});
    FemdemDrive still{};
    still.kind = FEMDEM_DRIVE_FIXED;
    femdem::check(femdem_world_drive_body(world, held, &still));
    FemdemBondLaw law = femdem::default_bond_law();
    law.damping = 0.5;
    world.add_bond(held, hung, 1e-3, 0.5, law);
    world.step_until(0.02);
    FemdemBond bond = world.bonds().at(0);
    const double weight = 9.81 * 2500.0 * ball.properties().volume;
    expect(std::abs(bond.force[2] / -weight - 1.0) < 0.02 && bond.broken == 0, "the bond bears the weight");
    std::printf("bond: %.3f N\n", -bond.force[2]);
}

// A rubber cube stands on a floor.
void deformable() {
    femdem::World world(femdem::default_parameters());
    world.add_plane({{0, 0, 1}, 0});
    FemdemMatter rubber = femdem::default_matter();
    rubber.young = 2e5;
    rubber.shear_viscosity = 50.0;
    femdem::Shape cube("cube", 0.1 * std::sqrt(3.0));
    uint32_t model = world.add_model(cube, 0.4, rubber);
    uint32_t body = world.add_deformable(model, {femdem::at(0, 0, 0.0501), {}});
    world.step_until(0.4);
    FemdemDeformable state = world.deformable(body);
    const double weight = 9.81 * state.mass;
    FemdemLoad load;
    femdem::check(femdem_world_wall_load(world, 0, &load));
    expect(std::abs(state.mass / 1.1 - 1.0) < 1e-9, "mass of the cube");
    expect(std::abs(load.force[2] / -weight - 1.0) < 0.03, "the floor bears the cube");
    double sum = 0;
    std::vector<double> stresses = world.stresses(body);
    for (std::size_t k = 2; k < stresses.size(); k += 6) {
        sum += stresses[k];
    }
    // Half of the weight over the face.
    const double mean = sum / (stresses.size() / 6.0);
    expect(std::abs(mean / (-0.5 * weight / 0.01) - 1.0) < 0.1, "mean stress of the cube");
    expect(world.node_positions(body).size() == 3 * state.node_count, "nodes of the cube");
    std::printf("deformable: %.2f N on the floor, mean stress %.0f Pa\n", -load.force[2], mean);
}

// What is wrong is an exception with words.
void refusals() {
    try {
        femdem::Shape("no such shape", 1.0);
        expect(false, "a shape without a name");
    } catch (const femdem::Error &error) {
        expect(error.status == FEMDEM_STATUS_REFUSED && error.what()[0] != '\0', "refusal");
    }
    FemdemShape freed;
    {
        femdem::Shape cube("cube", 1.0);
        freed = cube;
    }
    FemdemShapeProperties properties;
    expect(femdem_shape_properties(freed, &properties) == FEMDEM_STATUS_HANDLE, "a freed handle");
}

} // namespace

int main() {
    try {
        expect(femdem_abi() == FEMDEM_ABI_VERSION, "header and library");
        pair();
        batch();
        world();
        bond();
        deformable();
        refusals();
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
