/* femdem for C++17: owners that free what they hold, and exceptions in the place of statuses. Everything else is femdem.h. */
#ifndef FEMDEM_HPP
#define FEMDEM_HPP

#include "femdem.h"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace femdem {

/** What femdem refuses: the value, what is allowed, what to do. */
class Error : public std::runtime_error {
public:
    explicit Error(FemdemStatus status) : std::runtime_error(femdem_last_error()), status(status) {}
    FemdemStatus status;
};

/** Throws unless a status is FEMDEM_STATUS_OK. */
inline void check(FemdemStatus status) {
    if (status != FEMDEM_STATUS_OK) {
        throw Error(status);
    }
}

/** A handle with one owner. */
template <typename Handle, FemdemStatus (*free)(Handle)>
class Owner {
public:
    Owner() = default;
    explicit Owner(Handle handle) : handle_(handle) {}
    Owner(Owner &&other) noexcept : handle_(std::exchange(other.handle_, Handle{})) {}
    Owner &operator=(Owner &&other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Owner() { free(handle_); }
    /** For the functions of femdem.h. */
    operator Handle() const { return handle_; }

protected:
    Handle handle_{};
};

/** The pose of a body that is not turned. */
inline FemdemPose at(double x, double y, double z) { return {{x, y, z}, {1, 0, 0, 0}}; }

/** A list of a function that counts first. */
template <typename Item, typename Handle>
std::vector<Item> all(FemdemStatus (*ask)(Handle, Item *, std::size_t, std::size_t *), Handle handle) {
    std::size_t count = 0;
    check(ask(handle, nullptr, 0, &count));
    std::vector<Item> items(count);
    check(ask(handle, items.data(), count, &count));
    return items;
}

class Shape : public Owner<FemdemShape, femdem_shape_free> {
public:
    using Owner::Owner;
    /** By name; see femdem_shape_named. */
    explicit Shape(const std::string &name, double size, double mesh_size = 0) {
        check(femdem_shape_named(name.c_str(), size, mesh_size, &handle_));
    }
    static Shape file(const std::string &path, double unit, double mesh_size = 0) {
        Shape shape;
        check(femdem_shape_file(path.c_str(), unit, mesh_size, &shape.handle_));
        return shape;
    }
    /** Rows of three. */
    static Shape surface(const std::vector<double> &vertices, const std::vector<uint32_t> &triangles,
                         double mesh_size = 0) {
        Shape shape;
        check(femdem_shape_surface(vertices.data(), vertices.size() / 3, triangles.data(), triangles.size() / 3,
                                   mesh_size, &shape.handle_));
        return shape;
    }
    FemdemShapeProperties properties() const {
        FemdemShapeProperties properties;
        check(femdem_shape_properties(handle_, &properties));
        return properties;
    }
};

/** What two bodies do to each other. */
inline FemdemPair pair(double penalty, FemdemShape a, const FemdemPose &pose_a, FemdemShape b, const FemdemPose &pose_b) {
    FemdemPair pair;
    check(femdem_pair_evaluate(penalty, a, &pose_a, b, &pose_b, &pair));
    return pair;
}

inline FemdemLaw default_law() {
    FemdemLaw law;
    check(femdem_law_default(&law));
    return law;
}

class Batch : public Owner<FemdemBatch, femdem_batch_free> {
public:
    explicit Batch(const FemdemLaw &law) { check(femdem_batch_new(&law, &handle_)); }
    uint32_t add_body(FemdemShape shape, double density, uint32_t material = 0) {
        uint32_t body = 0;
        check(femdem_batch_add_body(handle_, shape, density, material, &body));
        return body;
    }
    FemdemSides add_box(const FemdemBox &inside, uint32_t material = 0) {
        FemdemSides sides;
        check(femdem_batch_add_box(handle_, &inside, material, &sides));
        return sides;
    }
    void move_wall(uint32_t wall, const FemdemMotion &motion) { check(femdem_batch_move_wall(handle_, wall, &motion)); }
    void update(const std::vector<FemdemMotion> &motions, double dt, std::vector<FemdemLoad> &loads) {
        loads.resize(motions.size());
        check(femdem_batch_update(handle_, motions.data(), motions.size(), dt, loads.data(), loads.size()));
    }
    FemdemBatchTotals totals() const {
        FemdemBatchTotals totals;
        check(femdem_batch_totals(handle_, &totals));
        return totals;
    }
    std::vector<FemdemContact> contacts() const { return all(femdem_batch_contacts, handle_); }
};

inline FemdemBondLaw default_bond_law() {
    FemdemBondLaw law;
    check(femdem_bond_law_default(&law));
    return law;
}

inline FemdemMatter default_matter() {
    FemdemMatter matter;
    check(femdem_matter_default(&matter));
    return matter;
}

inline FemdemFracture default_fracture() {
    FemdemFracture fracture;
    check(femdem_fracture_default(&fracture));
    return fracture;
}

inline FemdemWorldParameters default_parameters() {
    FemdemWorldParameters parameters;
    check(femdem_world_defaults(&parameters));
    return parameters;
}

class World : public Owner<FemdemWorld, femdem_world_free> {
public:
    explicit World(const FemdemWorldParameters &parameters) { check(femdem_world_new(&parameters, &handle_)); }
    explicit World(const std::vector<uint8_t> &bytes) {
        check(femdem_world_from_bytes(bytes.data(), bytes.size(), &handle_));
    }
    uint32_t add_body(FemdemShape shape, double density, const FemdemMotion &motion, uint32_t material = 0) {
        uint32_t body = 0;
        check(femdem_world_add_body(handle_, shape, density, &motion, material, &body));
        return body;
    }
    uint32_t add_plane(const FemdemPlane &plane, uint32_t material = 0) {
        uint32_t wall = 0;
        check(femdem_world_add_plane(handle_, &plane, material, &wall));
        return wall;
    }
    FemdemSides add_box(const FemdemBox &inside, uint32_t material = 0) {
        FemdemSides sides;
        check(femdem_world_add_box(handle_, &inside, material, &sides));
        return sides;
    }
    /** Of tetrahedra: rows of three, and of four. */
    uint32_t add_model(const std::vector<double> &points, const std::vector<uint32_t> &tets, const FemdemMatter &matter) {
        uint32_t model = 0;
        check(femdem_world_add_model(handle_, points.data(), points.size() / 3, tets.data(), tets.size() / 4, &matter,
                                     &model));
        return model;
    }
    /** Of a shape, which is filled with tetrahedra; see femdem_world_add_model_of_shape. */
    uint32_t add_model(FemdemShape shape, double mesh_size, const FemdemMatter &matter) {
        uint32_t model = 0;
        check(femdem_world_add_model_of_shape(handle_, shape, mesh_size, &matter, &model));
        return model;
    }
    /** It may break if it has a fracture. */
    uint32_t add_deformable(uint32_t model, const FemdemMotion &motion, const FemdemFracture *fracture = nullptr,
                            uint32_t material = 0) {
        uint32_t body = 0;
        check(femdem_world_add_deformable(handle_, model, &motion, fracture, material, &body));
        return body;
    }
    /** See femdem_world_drive_nodes; femdem_world_release ends it. */
    void drive_nodes(uint32_t body, const std::vector<uint32_t> &nodes, uint32_t axes, const FemdemDrive &drive) {
        check(femdem_world_drive_nodes(handle_, body, nodes.data(), nodes.size(), axes, &drive));
    }
    FemdemDeformable deformable(uint32_t body) const {
        FemdemDeformable deformable;
        check(femdem_world_deformable(handle_, body, &deformable));
        return deformable;
    }
    /** Three numbers for each node, m. */
    std::vector<double> node_positions(uint32_t body) const {
        std::vector<double> positions(3 * deformable(body).node_count);
        check(femdem_world_node_positions(handle_, body, positions.data(), positions.size() / 3));
        return positions;
    }
    /** Six numbers for each tetrahedron, Pa: xx, yy, zz, xy, yz, zx. */
    std::vector<double> stresses(uint32_t body) const {
        std::vector<double> stresses(6 * deformable(body).tet_count);
        check(femdem_world_stresses(handle_, body, stresses.data(), stresses.size() / 6));
        return stresses;
    }
    /** Makes bodies of fragments, and tells which. */
    std::vector<FemdemFragment> fragment_bodies() {
        std::size_t count = 0;
        check(femdem_world_fragment_bodies(handle_, &count));
        return all(femdem_world_new_fragments, handle_);
    }
    std::vector<uint32_t> deformables() const { return all(femdem_world_deformables, handle_); }
    /** Over the section that two bodies have between them; see femdem_world_add_bond for a polygon. */
    uint32_t add_bond(uint32_t body_a, uint32_t body_b, double gap, double ratio, const FemdemBondLaw &law) {
        uint32_t bond = 0;
        check(femdem_world_add_bond_between(handle_, body_a, body_b, gap, ratio, &law, &bond));
        return bond;
    }
    void step(uint64_t steps) { check(femdem_world_step(handle_, steps)); }
    void step_until(double time) { check(femdem_world_step_until(handle_, time)); }
    FemdemWorldState state() const {
        FemdemWorldState state;
        check(femdem_world_state(handle_, &state));
        return state;
    }
    FemdemLedger ledger() const {
        FemdemLedger ledger;
        check(femdem_world_ledger(handle_, &ledger));
        return ledger;
    }
    uint64_t hash() const {
        uint64_t hash = 0;
        check(femdem_world_hash(handle_, &hash));
        return hash;
    }
    std::vector<uint32_t> bodies() const { return all(femdem_world_bodies, handle_); }
    std::vector<FemdemMotion> motions() const { return all(femdem_world_motions, handle_); }
    std::vector<FemdemContact> contacts() const { return all(femdem_world_contacts, handle_); }
    std::vector<FemdemBond> bonds() const { return all(femdem_world_bonds, handle_); }
    std::vector<uint8_t> to_bytes() const { return all(femdem_world_to_bytes, handle_); }
};

} // namespace femdem

#endif
