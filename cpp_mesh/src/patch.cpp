#include "patch.hpp"

#include "errors.hpp"

#include <limits>
#include <map>

namespace cpp_mesh {

namespace {

// Number the parts of the cells with the given mark, connected across edges; -1 elsewhere.
int number_parts(const PlaneMesh& mesh, const EdgeTable& edges, const std::vector<char>& marked,
                 char mark, std::vector<int>& part) {
    int n_parts = 0;
    part.assign(mesh.cells.size(), -1);
    std::vector<int> waiting;
    for (int seed = 0; seed < static_cast<int>(mesh.cells.size()); ++seed) {
        if (marked[seed] != mark || part[seed] >= 0)
            continue;
        part[seed] = n_parts;
        waiting.assign(1, seed);
        while (!waiting.empty()) {
            const int c = waiting.back();
            waiting.pop_back();
            for (int k = 0; k < 3; ++k) {
                const int d = edges.across(c, k);
                if (d >= 0 && marked[d] == mark && part[d] < 0) {
                    part[d] = n_parts;
                    waiting.push_back(d);
                }
            }
        }
        ++n_parts;
    }
    return n_parts;
}

// Does the cell's edge k bound the patch?
bool is_rim(const EdgeTable& edges, const std::vector<char>& marked, int c, int k) {
    const int d = edges.across(c, k);
    return d < 0 || !marked[d];
}

bool close_pinches(const PlaneMesh& mesh, const EdgeTable& edges, std::vector<char>& marked) {
    std::vector<int> leaving(mesh.xy.size(), 0);
    for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c)
        for (int k = 0; k < 3; ++k)
            if (marked[c] && is_rim(edges, marked, c, k))
                ++leaving[mesh.cells[c][k]];
    bool has_changed = false;
    for (int node = 0; node < static_cast<int>(mesh.xy.size()); ++node) {
        if (leaving[node] < 2)
            continue;
        has_changed = true;
        for (const int* c = edges.begin(node); c != edges.end(node); ++c)
            marked[*c] = 1;
    }
    return has_changed;
}

bool fill_islands(const PlaneMesh& mesh, const EdgeTable& edges, std::vector<char>& marked) {
    std::vector<int> part;
    const int n_parts = number_parts(mesh, edges, marked, 0, part);
    std::vector<char> is_island(n_parts, 1);
    for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c)
        for (int k = 0; k < 3; ++k)
            if (part[c] >= 0 && edges.across(c, k) < 0)
                is_island[part[c]] = 0;
    bool has_changed = false;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        if (part[c] >= 0 && is_island[part[c]]) {
            marked[c] = 1;
            has_changed = true;
        }
    }
    return has_changed;
}

double loop_area(const std::vector<int>& loop, const std::vector<Vec2>& xy) {
    double area = 0.0;
    for (std::size_t k = 0; k < loop.size(); ++k)
        area +=
            0.5 * cross(xy[loop[k]] - xy[loop[0]], xy[loop[(k + 1) % loop.size()]] - xy[loop[0]]);
    return area;
}

} // namespace

std::vector<char> cells_in_discs(const PlaneMesh& mesh, const std::vector<Vec2>& centres,
                                 double radius) {
    std::vector<char> marked;
    for (const Triangle& cell : mesh.cells)
        marked.push_back(std::any_of(centres.begin(), centres.end(), [&](Vec2 centre) {
            return std::all_of(cell.begin(), cell.end(),
                               [&](int node) { return distance(mesh.xy[node], centre) <= radius; });
        }));
    return marked;
}

void mark_near(const PlaneMesh& mesh, const std::array<Vec2, 2>& segment, double margin,
               std::vector<char>& marked) {
    const Vec2 a = segment[0], b = segment[1];
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        if (marked[c])
            continue;
        const Vec2 p = mesh.xy[mesh.cells[c][0]], q = mesh.xy[mesh.cells[c][1]],
                   r = mesh.xy[mesh.cells[c][2]];
        if (std::min({p.x, q.x, r.x}) > std::max(a.x, b.x) + margin ||
            std::max({p.x, q.x, r.x}) < std::min(a.x, b.x) - margin ||
            std::min({p.y, q.y, r.y}) > std::max(a.y, b.y) + margin ||
            std::max({p.y, q.y, r.y}) < std::min(a.y, b.y) - margin)
            continue;
        const bool holds_a =
            twice_area(p, q, a) >= 0.0 && twice_area(q, r, a) >= 0.0 && twice_area(r, p, a) >= 0.0;
        if (holds_a || segment_distance(p, q, a, b) < margin ||
            segment_distance(q, r, a, b) < margin || segment_distance(r, p, a, b) < margin)
            marked[c] = 1;
    }
}

void make_simple(const PlaneMesh& mesh, const EdgeTable& edges, std::vector<char>& marked) {
    while (close_pinches(mesh, edges, marked) || fill_islands(mesh, edges, marked)) {
    }
}

std::vector<PatchPart> patch_parts(const PlaneMesh& mesh, const EdgeTable& edges,
                                   const std::vector<char>& marked) {
    std::vector<int> part;
    std::vector<PatchPart> parts(number_parts(mesh, edges, marked, 1, part));
    std::map<int, std::array<int, 2>> next; // rim node -> the node after it, part
    for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c) {
        if (!marked[c])
            continue;
        parts[part[c]].cells.push_back(c);
        for (int k = 0; k < 3; ++k)
            if (is_rim(edges, marked, c, k))
                next[mesh.cells[c][k]] = {mesh.cells[c][(k + 1) % 3], part[c]};
    }
    while (!next.empty()) {
        const int start = next.begin()->first, owner = next.begin()->second[1];
        std::vector<int> loop;
        for (int node = start; next.count(node) > 0;) {
            loop.push_back(node);
            const int following = next.at(node)[0];
            next.erase(node);
            node = following;
        }
        std::vector<std::vector<int>>& loops = parts[owner].loops;
        if (loop_area(loop, mesh.xy) > 0.0)
            loops.insert(loops.begin(), std::move(loop));
        else
            loops.push_back(std::move(loop));
    }
    return parts;
}

int part_around(const PlaneMesh& mesh, const std::vector<PatchPart>& parts, Vec2 p) {
    int best = -1;
    double depth = -std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < parts.size(); ++i) {
        for (int c : parts[i].cells) {
            const Triangle& node = mesh.cells[c];
            const Vec2 a = mesh.xy[node[0]], b = mesh.xy[node[1]], d = mesh.xy[node[2]];
            const double inside =
                std::min({twice_area(a, b, p), twice_area(b, d, p), twice_area(d, a, p)}) /
                twice_area(a, b, d);
            if (inside > depth) {
                depth = inside;
                best = static_cast<int>(i);
            }
        }
    }
    if (!(depth >= -1e-6))
        throw MeshError("growth reaches beyond the patch that is remeshed");
    return best;
}

bool is_inside(const PlaneMesh& mesh, const EdgeTable& edges, int node) {
    for (const int* c = edges.begin(node); c != edges.end(node); ++c)
        for (int k = 0; k < 3; ++k)
            if (edges.across(*c, k) < 0 &&
                (mesh.cells[*c][k] == node || mesh.cells[*c][(k + 1) % 3] == node))
                return false;
    return true;
}

} // namespace cpp_mesh
