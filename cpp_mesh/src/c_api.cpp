// The C functions: they copy in and out, and turn exceptions into codes.
#include "cpp_mesh/c_api.h"

#include "errors.hpp"
#include "judge.hpp"
#include "locate.hpp"
#include "mesh.hpp"
#include "narrow_places.hpp"
#include "planned_sizes.hpp"
#include "store.hpp"

#include <memory>
#include <mutex>
#include <string>

struct cm_mesh {
    cpp_mesh::Mesh mesh;
    // Made when a point is looked for, kept for the next one.
    mutable std::once_flag tree_is_made;
    mutable std::unique_ptr<const cpp_mesh::CellTree> tree;

    explicit cm_mesh(cpp_mesh::Mesh made) : mesh(std::move(made)) {}

    const cpp_mesh::CellTree& cells_by_place() const {
        std::call_once(tree_is_made, [this] {
            tree = std::make_unique<const cpp_mesh::CellTree>(mesh.plane.xy, mesh.plane.cells);
        });
        return *tree;
    }
};

namespace {

using namespace cpp_mesh;

constexpr int success = 0, failure = 1;

std::string& last_error() {
    thread_local std::string text;
    return text;
}

std::optional<Fault>& last_fault() {
    thread_local std::optional<Fault> fault;
    return fault;
}

int fail(const std::string& message, const Fault& fault) {
    last_error() = message;
    last_fault() = fault;
    return failure;
}

int fail(const std::string& message) {
    return fail(message, Fault{FaultKind::other, {}, {}, message});
}

// Run an action at the border.
template <typename Action> int guarded(Action&& action) {
    try {
        last_error().clear();
        last_fault().reset();
        action();
        return success;
    } catch (const std::bad_alloc&) {
        return fail("there is not enough memory for the mesh");
    } catch (const MeshError& error) {
        return fail(error.what(), error.fault());
    } catch (const std::exception& error) {
        return fail(error.what());
    } catch (...) {
        return fail("an unknown error occurred in the mesh library");
    }
}

void require(bool condition, const char* message) {
    if (!condition)
        throw MeshError(message);
}

Network network_from(const cm_network* given) {
    require(given != nullptr, "no network was given");
    Network network;
    network.first.assign(given->first, given->first + given->n_fractures + 1);
    for (int v = 0; v < network.first.back(); ++v)
        network.xy.push_back({given->xy[2 * v], given->xy[2 * v + 1]});
    network.s_start.assign(given->s_start, given->s_start + given->n_fractures);
    return network;
}

std::vector<Vec2> points_from(int32_t n, const double* xy) {
    std::vector<Vec2> points;
    for (int32_t i = 0; i < n; ++i)
        points.push_back({xy[2 * i], xy[2 * i + 1]});
    return points;
}

Domain domain_from(const cm_spec& given) {
    if (given.n_corners == 0)
        return Domain(Rectangle{given.x_min, given.x_max, given.y_min, given.y_max});
    require(given.n_corners > 0 && given.corners != nullptr && given.edge_side != nullptr,
            "the boundary has no corners or no side numbers");
    return Domain(points_from(given.n_corners, given.corners),
                  std::vector<int>(given.edge_side, given.edge_side + given.n_corners));
}

std::vector<std::array<double, 2>> radii_at_ends(int n_fractures, const double* end_radius) {
    std::vector<std::array<double, 2>> radii;
    for (int f = 0; f < n_fractures; ++f)
        radii.push_back({end_radius[2 * f], end_radius[2 * f + 1]});
    return radii;
}

std::vector<std::vector<Vec2>> guides_from(const cm_spec& given) {
    std::vector<std::vector<Vec2>> guides;
    const double* xy = given.guide_xy;
    for (int32_t i = 0; i < given.n_guides; ++i) {
        guides.push_back(points_from(given.guide_count[i], xy));
        xy += 2 * given.guide_count[i];
    }
    return guides;
}

Specification specification_from(const cm_spec* given, int n_fractures) {
    require(given != nullptr, "no specification was given");
    Specification spec;
    spec.domain = domain_from(*given);
    spec.size_fracture = given->size_fracture;
    spec.size_boundary = given->size_boundary;
    spec.is_window = given->is_window != 0;
    spec.rosette_sectors = given->rosette_sectors;
    spec.rosette_radii.usual = given->rosette_radius;
    if (given->end_radius != nullptr)
        spec.rosette_radii.at_end = radii_at_ends(n_fractures, given->end_radius);
    spec.fixed_points = points_from(given->n_fixed, given->fixed);
    spec.guides = guides_from(*given);
    spec.joint_size = given->joint_size;
    for (int32_t i = 0; i < given->n_refined; ++i) {
        const double* place = given->refined + 4 * i;
        spec.refined.push_back(corner_disc({place[0], place[1]}, place[2]));
        spec.refined.back().radius = place[3];
    }
    if (given->n_foci > 0)
        spec.foci = {points_from(given->n_foci, given->foci), given->size_fracture,
                     given->focus_slope, given->focus_size};
    spec.is_rough = given->is_rough != 0;
    if (given->ring_slope > 0.0)
        spec.ring_slope = given->ring_slope;
    if (given->own_size != nullptr)
        spec.own_size.assign(given->own_size, given->own_size + n_fractures);
    return spec;
}

const PatchMap& map_of(const cm_mesh* mesh) {
    require(mesh != nullptr, "no mesh was given");
    require(mesh->mesh.map.has_value(), "the mesh was not made by remeshing");
    return *mesh->mesh.map;
}

void copy_points(const std::vector<Vec2>& points, double* target) {
    for (const Vec2& p : points) {
        *target++ = p.x;
        *target++ = p.y;
    }
}

void copy_matrix(const SplitMesh& mesh, const cm_arrays& to) {
    copy_points(mesh.xy, to.xy);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (int k = 0; k < 3; ++k) {
            to.cell_nodes[3 * c + k] = mesh.cells[c][k];
            to.cell_faces[3 * c + k] = mesh.cell_faces[c][k];
        }
    }
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const Face& face = mesh.faces[f];
        for (int k = 0; k < 2; ++k) {
            to.face_nodes[2 * f + k] = face.node[k];
            to.face_cells[2 * f + k] = face.cell[k];
        }
        to.face_side[f] = face.side;
        to.face_fracture_cell[f] = face.fracture_cell;
    }
}

void copy_fractures(const SplitMesh& mesh, const cm_arrays& to) {
    for (std::size_t i = 0; i < mesh.fracture_cells.size(); ++i) {
        to.fcell_fracture[i] = mesh.fracture_cells[i].fracture;
        for (int k = 0; k < 2; ++k) {
            to.fcell_points[2 * i + k] = mesh.fracture_cell_points[i][k];
            to.fcell_faces[2 * i + k] = mesh.fracture_cell_faces[i][k];
            to.fcell_s[2 * i + k] = mesh.fracture_cells[i].s[k];
        }
    }
    int next = 0;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const FracturePoint& point = mesh.points[p];
        to.point_xy[2 * p] = point.xy.x;
        to.point_xy[2 * p + 1] = point.xy.y;
        to.point_kind[p] = static_cast<int32_t>(point.kind);
        to.point_first[p] = next;
        for (int cell : point.cells)
            to.point_cells[next++] = cell;
    }
    to.point_first[mesh.points.size()] = next;
    for (std::size_t t = 0; t < mesh.tips.size(); ++t) {
        const Tip& tip = mesh.tips[t];
        to.tip_point[t] = tip.point;
        to.tip_node[t] = tip.node;
        to.tip_fracture[t] = tip.fracture;
        to.tip_end[t] = tip.end;
        to.tip_direction[2 * t] = tip.direction.x;
        to.tip_direction[2 * t + 1] = tip.direction.y;
        to.tip_radius[t] = tip.radius;
    }
}

} // namespace

const char* cm_last_error(void) {
    return last_error().c_str();
}

void cm_last_fault(cm_fault* fault) {
    if (fault == nullptr)
        return;
    *fault = cm_fault{};
    if (!last_fault())
        return;
    const Fault& last = *last_fault();
    fault->kind = static_cast<int32_t>(last.kind);
    for (const Culprit& culprit : last.culprits) {
        fault->culprit_kind[fault->n_culprits] = static_cast<int32_t>(culprit.kind);
        fault->culprit[fault->n_culprits++] = culprit.number;
    }
    if (last.place) {
        fault->has_place = 1;
        fault->x = last.place->x;
        fault->y = last.place->y;
    }
    fault->reason = last.reason.c_str();
}

int cm_check(const cm_spec* spec, const cm_network* network, int32_t capacity, cm_joint* joints,
             int32_t* n_joints, double* n_cells) {
    return guarded([&] {
        require(n_joints != nullptr, "no place was given for the number of joints");
        *n_joints = 0;
        const Network fractures = network_from(network);
        const Specification wanted = specification_from(spec, fractures.size());
        const Graph graph = judged_graph(wanted, fractures);
        check_fixed_points(graph);
        std::vector<RosettePlan> plans;
        if (wanted.rosette_sectors > 0)
            plans = plan_rosettes(graph, wanted.domain, wanted.rosette_radii);
        if (n_cells != nullptr) {
            const ExpectedCells expected = expected_cells(wanted, graph, plans);
            n_cells[0] = expected.cells;
            n_cells[1] = expected.fracture_cells;
        }
        const std::vector<Joint> found = joints_of(graph);
        *n_joints = static_cast<int32_t>(found.size());
        for (int32_t k = 0; k < std::min(capacity, *n_joints); ++k)
            joints[k] = {
                {found[k].fracture[0], found[k].fracture[1]}, found[k].xy.x, found[k].xy.y};
    });
}

int cm_create(const cm_spec* spec, const cm_network* network, cm_mesh** mesh) {
    return guarded([&] {
        require(mesh != nullptr, "no place was given for the mesh");
        *mesh = nullptr;
        const Network fractures = network_from(network);
        *mesh = new cm_mesh{create_mesh(specification_from(spec, fractures.size()), fractures)};
    });
}

int cm_create_sized(const cm_spec* spec, const cm_network* network, const cm_mesh* old_mesh,
                    int32_t n_sizes, const double* cell_size, cm_mesh** mesh) {
    return guarded([&] {
        require(mesh != nullptr, "no place was given for the mesh");
        *mesh = nullptr;
        require(old_mesh != nullptr && cell_size != nullptr, "no old mesh or no sizes were given");
        const Network fractures = network_from(network);
        require(n_sizes == static_cast<int32_t>(old_mesh->mesh.plane.cells.size()),
                "the old mesh has another number of cells than sizes are given");
        const std::vector<double> sizes(cell_size, cell_size + n_sizes);
        *mesh = new cm_mesh{create_mesh_sized(specification_from(spec, fractures.size()), fractures,
                                              old_mesh->mesh, sizes)};
    });
}

int cm_sizes(const cm_mesh* mesh, cm_counts* counts) {
    return guarded([&] {
        require(mesh != nullptr && counts != nullptr, "no mesh was given");
        const SplitMesh& split = mesh->mesh.split;
        counts->n_nodes = static_cast<int32_t>(split.xy.size());
        counts->n_cells = static_cast<int32_t>(split.cells.size());
        counts->n_faces = static_cast<int32_t>(split.faces.size());
        counts->n_fracture_cells = static_cast<int32_t>(split.fracture_cells.size());
        counts->n_fracture_points = static_cast<int32_t>(split.points.size());
        counts->n_point_cells = 2 * counts->n_fracture_cells;
        counts->n_tips = static_cast<int32_t>(split.tips.size());
    });
}

int cm_copy(const cm_mesh* mesh, const cm_arrays* arrays) {
    return guarded([&] {
        require(mesh != nullptr && arrays != nullptr, "no mesh was given");
        copy_matrix(mesh->mesh.split, *arrays);
        copy_fractures(mesh->mesh.split, *arrays);
    });
}

int cm_quality(const cm_mesh* mesh, double* smallest_angle, int32_t* worst_cell) {
    return guarded([&] {
        require(mesh != nullptr, "no mesh was given");
        const Quality quality = quality_of(mesh->mesh.plane);
        *smallest_angle = quality.smallest_angle;
        *worst_cell = quality.worst_cell;
    });
}

int cm_locate(const cm_mesh* mesh, int32_t n_points, const double* xy, int32_t* cells) {
    return guarded([&] {
        require(mesh != nullptr, "no mesh was given");
        const CellTree& tree = mesh->cells_by_place();
        int found = -1; // points that follow each other are often near to each other
        for (int32_t p = 0; p < n_points; ++p) {
            found = tree.locate({xy[2 * p], xy[2 * p + 1]}, found);
            cells[p] = found;
        }
    });
}

int cm_remesh(const cm_mesh* old_mesh, const cm_network* network, int32_t n_centres,
              const double* centres, double radius, double size, cm_mesh** new_mesh) {
    return guarded([&] {
        require(new_mesh != nullptr, "no place was given for the mesh");
        *new_mesh = nullptr;
        require(old_mesh != nullptr, "no mesh was given");
        *new_mesh = new cm_mesh{remesh(old_mesh->mesh, network_from(network),
                                       points_from(n_centres, centres), radius, size)};
    });
}

int cm_move_tips(const cm_mesh* old_mesh, const cm_network* network, double reach,
                 cm_mesh** new_mesh) {
    return guarded([&] {
        require(new_mesh != nullptr, "no place was given for the mesh");
        *new_mesh = nullptr;
        require(old_mesh != nullptr, "no mesh was given");
        *new_mesh = new cm_mesh{move_tips(old_mesh->mesh, network_from(network), reach)};
    });
}

int cm_grow(const cm_mesh* old_mesh, const cm_network* network, const double* end_radius,
            cm_mesh** new_mesh) {
    return guarded([&] {
        require(new_mesh != nullptr, "no place was given for the mesh");
        *new_mesh = nullptr;
        require(old_mesh != nullptr, "no mesh was given");
        const Network fractures = network_from(network);
        RosetteRadii radii = old_mesh->mesh.specification.rosette_radii;
        radii.at_end.clear();
        if (end_radius != nullptr)
            radii.at_end = radii_at_ends(fractures.size(), end_radius);
        *new_mesh = new cm_mesh{grow_mesh(old_mesh->mesh, fractures, radii)};
    });
}

int cm_map_sizes(const cm_mesh* new_mesh, int32_t* n_overlaps) {
    return guarded(
        [&] { *n_overlaps = static_cast<int32_t>(map_of(new_mesh).overlap_cell.size()); });
}

int cm_map_copy(const cm_mesh* new_mesh, int32_t* cell_old, int32_t* overlap_first,
                int32_t* overlap_cell, double* overlap_area, int32_t* fcell_old) {
    return guarded([&] {
        const PatchMap& map = map_of(new_mesh);
        std::copy(map.cell_old.begin(), map.cell_old.end(), cell_old);
        std::copy(map.overlap_first.begin(), map.overlap_first.end(), overlap_first);
        std::copy(map.overlap_cell.begin(), map.overlap_cell.end(), overlap_cell);
        std::copy(map.overlap_area.begin(), map.overlap_area.end(), overlap_area);
        for (const FractureCell& cell : new_mesh->mesh.split.fracture_cells)
            *fcell_old++ = cell.old_cell;
    });
}

int cm_store(const cm_mesh* mesh, int64_t capacity, char* bytes, int64_t* n_bytes) {
    return guarded([&] {
        require(mesh != nullptr && n_bytes != nullptr, "no mesh was given");
        *n_bytes = static_cast<int64_t>(stored_size(mesh->mesh));
        if (capacity >= *n_bytes)
            store(mesh->mesh, bytes);
    });
}

int cm_load(int64_t n_bytes, const char* bytes, cm_mesh** mesh) {
    return guarded([&] {
        require(mesh != nullptr, "no place was given for the mesh");
        *mesh = nullptr;
        *mesh = new cm_mesh{load(bytes, static_cast<std::size_t>(n_bytes))};
    });
}

void cm_destroy(cm_mesh** mesh) {
    if (mesh != nullptr) {
        delete *mesh;
        *mesh = nullptr;
    }
}
