#include "lone_sectors.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>

namespace cpp_mesh {

namespace {

std::pair<int, int> ordered(int a, int b) {
    return {std::min(a, b), std::max(a, b)};
}

class Divider {
public:
    Divider(PlaneMesh& mesh, int first_cell) : mesh_(mesh), first_cell_(first_cell) {
        for (const FractureCell& cell : mesh.fracture_cells)
            fractures_.insert(ordered(cell.node[0], cell.node[1]));
        for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c)
            enter(c);
    }

    // The first cell that must be divided, until there is none: of those before the next one only
    // what has changed is looked at again.
    void run() {
        std::set<int> again;
        for (int next = first_cell_; next < static_cast<int>(mesh_.cells.size());) {
            const int c = again.empty() ? next : *again.begin();
            again.erase(c);
            const int k = edge_to_halve(c);
            if (k < 0) {
                next += c == next ? 1 : 0;
                continue;
            }
            const int behind = across(c, k);
            divide(c, k);
            for (int changed : {c, behind})
                if (changed >= first_cell_ && changed < next)
                    again.insert(changed);
        }
    }

private:
    // The edge of a cell that is opposite to a corner that it fills alone, or -1.
    int edge_to_halve(int c) const {
        for (int k = 0; k < 3; ++k)
            if (fills_sector(c, k) && may_change(across(c, (k + 1) % 3)))
                return (k + 1) % 3;
        return -1;
    }

    static std::uint64_t key(int a, int b) {
        return (std::uint64_t{static_cast<std::uint32_t>(a)} << 32U) |
               std::uint64_t{static_cast<std::uint32_t>(b)};
    }

    // The boundary of a cell runs along its edges.
    void enter(int c) {
        const Triangle& cell = mesh_.cells[c];
        for (int k = 0; k < 3; ++k)
            cell_of_[key(cell[k], cell[(k + 1) % 3])] = c;
    }

    // The cell on the other side of edge k, or -1.
    int across(int c, int k) const {
        const Triangle& cell = mesh_.cells[c];
        const auto found = cell_of_.find(key(cell[(k + 1) % 3], cell[k]));
        return found == cell_of_.end() ? -1 : found->second;
    }

    bool is_fracture(int c, int k) const {
        const Triangle& cell = mesh_.cells[c];
        return fractures_.count(ordered(cell[k], cell[(k + 1) % 3])) > 0;
    }

    // The two edges at corner k of a cell part it from its neighbours, one of them a fracture.
    bool fills_sector(int c, int k) const {
        const int after = k, before = (k + 2) % 3;
        const bool wall = is_fracture(c, after), other_wall = is_fracture(c, before);
        return (wall || other_wall) && (wall || across(c, after) < 0) &&
               (other_wall || across(c, before) < 0);
    }

    bool may_change(int c) const { return c < 0 || c >= first_cell_; }

    // Halve edge k of a cell.
    void divide(int c, int k) {
        const int a = mesh_.cells[c][k], b = mesh_.cells[c][(k + 1) % 3];
        const int middle = static_cast<int>(mesh_.xy.size());
        mesh_.xy.push_back(0.5 * (mesh_.xy[a] + mesh_.xy[b]));
        const int behind = across(c, k);
        halve(c, a, b, middle);
        if (behind >= 0)
            halve(behind, b, a, middle);
        if (fractures_.erase(ordered(a, b)) == 0)
            return;
        fractures_.insert(ordered(a, middle));
        fractures_.insert(ordered(middle, b));
        halve_fracture_cell(a, b, middle);
    }

    // A cell whose boundary runs from a to b.
    void halve(int c, int a, int b, int middle) {
        Triangle rest = mesh_.cells[c];
        std::replace(mesh_.cells[c].begin(), mesh_.cells[c].end(), b, middle);
        std::replace(rest.begin(), rest.end(), a, middle);
        mesh_.cells.push_back(rest);
        cell_of_.erase(key(a, b));
        enter(c);
        enter(static_cast<int>(mesh_.cells.size()) - 1);
    }

    void halve_fracture_cell(int a, int b, int middle) {
        auto& cells = mesh_.fracture_cells;
        const auto cell = std::find_if(cells.begin(), cells.end(), [&](const FractureCell& f) {
            return ordered(f.node[0], f.node[1]) == ordered(a, b);
        });
        FractureCell rest = *cell;
        cell->node[1] = middle;
        rest.node[0] = middle;
        cell->s[1] = 0.5 * (cell->s[0] + cell->s[1]);
        rest.s[0] = cell->s[1];
        cells.insert(cell + 1, rest);
    }

    PlaneMesh& mesh_;
    const int first_cell_;
    std::set<std::pair<int, int>> fractures_;        // edges, by their nodes
    std::unordered_map<std::uint64_t, int> cell_of_; // by the nodes of a directed edge
};

} // namespace

void divide_lone_sectors(PlaneMesh& mesh, int first_cell) {
    Divider(mesh, first_cell).run();
}

} // namespace cpp_mesh
