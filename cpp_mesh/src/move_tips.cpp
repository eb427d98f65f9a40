// Tips that go on along the last pieces of their paths, or turn about where these begin: the cells
// keep their nodes, and these move along. The elements around a tip are scaled and turned as the
// piece is; fractures, the body and what is far away stay; what lies between moves so that edges,
// shorter ones less than longer ones, are changed as little as possible.
#include "errors.hpp"
#include "mesh.hpp"
#include "smooth.hpp"

#include <algorithm>
#include <cmath>

namespace cpp_mesh {

namespace {

// A piece may become so many times longer, or shorter.
constexpr double largest_stretch = 3.0;

// It may turn by up to this [rad].
constexpr double largest_turn = 0.3;

// Cells may get smaller angles than they have, down to this one [rad], and those that have smaller
// ones keep this share of its sine.
constexpr double fair_moved_angle = 0.3;
constexpr double kept_shape = 0.9;

// Displacements are as good as this share of the largest.
constexpr double precision = 1e-3;
constexpr int most_sweeps = 400;
constexpr double relaxation = 1.6; // of the sweeps

// The last piece of a path, as it is in the mesh and as it shall be.
struct Move {
    int fracture = 0, end = 0; // 1 start, 2 end
    Vec2 start, from, to;

    double length() const { return distance(start, from); }
    double ratio() const { return distance(start, to) / length(); }
    double distance_to(Vec2 p) const { return distance_to_segment(p, start, from); }

    // The similarity that keeps the start and takes the tip along.
    Vec2 image(Vec2 p) const {
        const Vec2 a = from - start, b = to - start, r = p - start;
        const double square = dot(a, a), along = dot(a, b) / square, across = cross(a, b) / square;
        return start + Vec2{along * r.x - across * r.y, across * r.x + along * r.y};
    }
};

// Ends of fractures that have moved; everything else must be as it was.
std::vector<Move> moves_between(const Network& before, const Network& after) {
    if (before.first != after.first)
        throw MeshError("the network has other vertices than the mesh");
    std::vector<Move> moves;
    for (int f = 0; f < before.size(); ++f) {
        const int first = before.first[f], last = before.first[f + 1] - 1;
        for (int v = first; v <= last; ++v) {
            if (before.xy[v] == after.xy[v])
                continue;
            if (v != first && v != last)
                throw MeshError("the network has moved between its ends");
            if (last == first + 1)
                throw MeshError("a fracture of one piece is not moved");
            const int next = v == first ? v + 1 : v - 1;
            moves.push_back({f, v == first ? 1 : 2, before.xy[next], before.xy[v], after.xy[v]});
        }
    }
    return moves;
}

// Moves the nodes of a copy.
class Mover {
public:
    Mover(const Mesh& old_mesh, const Network& network)
        : old_(old_mesh.plane), made_(old_mesh), shift_(old_.xy.size()),
          is_free_(old_.xy.size(), 1) {
        made_.network = network;
        for (const FractureCell& cell : old_.fracture_cells)
            for (int node : cell.node)
                is_free_[node] = 0;
        for (const Face& face : old_mesh.split.faces)
            if (face.side > 0)
                for (int k = 0; k < 2; ++k)
                    is_free_[plane_node(old_mesh, face, k)] = 0;
    }

    Mesh run(const std::vector<Move>& moves, double reach) {
        for (std::size_t v = 0; v < old_.xy.size(); ++v)
            is_free_[v] =
                is_free_[v] != 0 && std::any_of(moves.begin(), moves.end(), [&](const Move& move) {
                    return move.distance_to(old_.xy[v]) < reach * move.length();
                });
        for (const Move& move : moves)
            take_along(move);
        relax();
        for (std::size_t v = 0; v < shift_.size(); ++v)
            made_.plane.xy[v] = old_.xy[v] + shift_[v];
        std::vector<int> free;
        for (std::size_t v = 0; v < shift_.size(); ++v)
            if (is_free_[v])
                free.push_back(static_cast<int>(v));
        smooth(made_.plane, free);
        check_shapes();
        hand_on();
        return std::move(made_);
    }

private:
    // A face on the outer boundary has one cell, and its nodes follow each other around that.
    static int plane_node(const Mesh& mesh, const Face& face, int k) {
        const Triangle& split = mesh.split.cells[face.cell[0]];
        for (int corner = 0; corner < 3; ++corner)
            if (split[corner] == face.node[k])
                return mesh.plane.cells[face.cell[0]][corner];
        throw MeshError("a face has a node that its cell has not");
    }

    void take_along(const Move& move) {
        Tip* tip = nullptr;
        for (Tip& candidate : made_.split.tips)
            if (candidate.fracture == move.fracture && candidate.end == move.end)
                tip = &candidate;
        if (tip == nullptr) {
            if (touches_box(move))
                throw MeshError("an end that is no tip has moved");
            return; // outside the window
        }
        const double ratio = move.ratio();
        const double turn = angle_between(move.from - move.start, move.to - move.start);
        if (!(ratio <= largest_stretch && ratio >= 1.0 / largest_stretch && turn <= largest_turn))
            throw MeshError("a tip has moved too far");
        const int node = made_.split.points[tip->point].plane_node;
        if (old_.xy[node] != move.from)
            throw MeshError("a tip is not where the network has it");
        take_piece(move, node);
        for (const Triangle& cell : old_.cells)
            for (int corner : cell)
                if (corner == node)
                    for (int k : cell)
                        place(move, k);
        tip->direction = unit(move.to - move.start);
        tip->radius *= ratio;
        for (Rosette& rosette : made_.plane.rosettes)
            if (rosette.tip_node == node)
                rosette.radius *= ratio;
    }

    bool touches_box(const Move& move) const {
        const Rectangle& box = made_.specification.domain.box();
        const auto [left, right] = std::minmax({move.start.x, move.from.x, move.to.x});
        const auto [low, high] = std::minmax({move.start.y, move.from.y, move.to.y});
        return left <= box.x_max && right >= box.x_min && low <= box.y_max && high >= box.y_min;
    }

    void place(const Move& move, int node) {
        shift_[node] = move.image(old_.xy[node]) - old_.xy[node];
        is_free_[node] = 0;
    }

    // The cells of the piece, from the tip back to where it starts.
    void take_piece(const Move& move, int node) {
        const double whole = distance(move.start, move.from);
        double left = whole;
        bool any_left = true;
        while (any_left && left > 1e-9 * whole) {
            any_left = false;
            for (std::size_t i = 0; i < old_.fracture_cells.size(); ++i) {
                const FractureCell& cell = old_.fracture_cells[i];
                const int outer = move.end == 1 ? 0 : 1;
                if (cell.fracture != move.fracture || cell.node[outer] != node)
                    continue;
                place(move, node);
                const double s_start = start_of(move);
                for (int k = 0; k < 2; ++k)
                    made_.plane.fracture_cells[i].s[k] =
                        s_start + move.ratio() * (cell.s[k] - s_start);
                node = cell.node[1 - outer];
                left = distance(move.start, old_.xy[node]);
                any_left = true;
                break;
            }
        }
        if (!any_left)
            throw MeshError("the mesh lacks a part of a path segment");
    }

    // Arc length where a piece begins [m].
    double start_of(const Move& move) const {
        const Network& network = made_.network;
        double s = network.s_start[move.fracture];
        const int first = network.first[move.fracture];
        const int last = move.end == 1 ? first + 1 : network.first[move.fracture + 1] - 2;
        for (int v = first; v < last; ++v)
            s += distance(network.xy[v], network.xy[v + 1]);
        return s;
    }

    // Displacements of the free nodes: each the mean of those around it, which count by the inverse
    // fourth power of their distance. So small cells keep their shapes, and large ones take the
    // change: with the inverse distance itself, pieces could become a third longer, not twice.
    void relax() {
        double largest = 0.0;
        for (Vec2 shift : shift_)
            largest = std::max(largest, length(shift));
        std::vector<std::vector<std::pair<int, double>>> around(shift_.size());
        for (const Triangle& cell : old_.cells)
            for (int k = 0; k < 3; ++k) {
                const int a = cell[k], b = cell[(k + 1) % 3];
                if (!is_free_[a])
                    continue; // each edge of a free node is seen once from either cell
                const Vec2 edge = old_.xy[b] - old_.xy[a];
                around[a].emplace_back(b, 1.0 / (dot(edge, edge) * dot(edge, edge)));
            }
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            double change = 0.0;
            for (std::size_t v = 0; v < shift_.size(); ++v) {
                if (around[v].empty())
                    continue;
                Vec2 sum;
                double weights = 0.0;
                for (const auto& [other, weight] : around[v]) {
                    sum = sum + weight * shift_[other];
                    weights += weight;
                }
                const Vec2 step = relaxation * ((1.0 / weights) * sum - shift_[v]);
                shift_[v] = shift_[v] + step;
                change = std::max(change, length(step));
            }
            if (change <= precision * largest)
                return;
        }
    }

    void check_shapes() const {
        const double fair = std::sin(fair_moved_angle);
        for (const Triangle& cell : old_.cells) {
            const auto shape = [&](const std::vector<Vec2>& xy) {
                return sine_of_smallest_angle(xy[cell[0]], xy[cell[1]], xy[cell[2]]);
            };
            const double now = shape(made_.plane.xy);
            if (!(now >= fair) && !(now >= kept_shape * shape(old_.xy)))
                throw MeshError("cells would have a bad shape");
        }
    }

    // To the mesh that is split.
    void hand_on() {
        SplitMesh& split = made_.split;
        const PlaneMesh& plane = made_.plane;
        for (std::size_t c = 0; c < plane.cells.size(); ++c)
            for (int k = 0; k < 3; ++k)
                split.xy[split.cells[c][k]] = plane.xy[plane.cells[c][k]];
        for (std::size_t i = 0; i < plane.fracture_cells.size(); ++i)
            split.fracture_cells[i].s = plane.fracture_cells[i].s;
        for (FracturePoint& point : split.points)
            point.xy = plane.xy[point.plane_node];
    }

    const PlaneMesh& old_;
    Mesh made_;
    std::vector<Vec2> shift_;
    std::vector<char> is_free_;
};

} // namespace

Mesh move_tips(const Mesh& old_mesh, const Network& network, double reach) {
    const std::vector<Move> moves = moves_between(old_mesh.network, network);
    return moves.empty() ? old_mesh : Mover(old_mesh, network).run(moves, reach);
}

} // namespace cpp_mesh
