#include "store.hpp"

#include "check_mesh.hpp"
#include "errors.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>

namespace cpp_mesh {

namespace {

enum class Mode { count, store, load };

template <std::size_t n> bool are_within(const std::array<int, n>& numbers, std::size_t end) {
    return std::all_of(numbers.begin(), numbers.end(), [&](int number) {
        return number >= 0 && static_cast<std::size_t>(number) < end;
    });
}

// Visits every member of a mesh in the same order in all modes.
class Archive {
public:
    Archive(Mode mode, char* place, const char* end) : mode_(mode), place_(place), end_(end) {}

    template <typename... Members> void operator()(Members&... members) { (visit(members), ...); }

    std::size_t size() const { return size_; }
    bool is_at_end() const { return place_ == end_; }

private:
    void raw(void* data, std::size_t n_bytes) {
        size_ += n_bytes;
        if (mode_ == Mode::count || n_bytes == 0)
            return;
        if (n_bytes > static_cast<std::size_t>(end_ - place_))
            throw MeshError("the stored mesh ends too early");
        if (mode_ == Mode::store)
            std::memcpy(place_, data, n_bytes);
        else
            std::memcpy(data, place_, n_bytes);
        place_ += n_bytes;
    }

    template <typename T> void visit(T& value) {
        static_assert(std::is_trivially_copyable_v<T>, "this type needs a separate visit");
        raw(&value, sizeof(T));
    }

    template <typename T> void visit(std::vector<T>& values) {
        std::size_t n = values.size();
        visit(n);
        if (mode_ == Mode::load) {
            if (n > static_cast<std::size_t>(end_ - place_))
                throw MeshError("the stored mesh ends too early");
            values.resize(n);
        }
        if constexpr (std::is_trivially_copyable_v<T>)
            raw(values.data(), n * sizeof(T));
        else
            for (T& value : values)
                visit(value);
    }

    void visit(std::shared_ptr<const NodalSizes>& sizes) {
        bool exists = sizes != nullptr;
        visit(exists);
        if (!exists)
            return;
        std::vector<Vec2> xy;
        std::vector<Triangle> cells;
        std::vector<double> size;
        if (mode_ != Mode::load) {
            xy = sizes->xy();
            cells = sizes->cells();
            size = sizes->sizes();
        }
        (*this)(xy, cells, size);
        if (mode_ != Mode::load)
            return;
        if (size.size() != xy.size() || cells.empty())
            throw MeshError("the stored mesh has sizes of other nodes");
        for (const Triangle& cell : cells)
            if (!are_within(cell, xy.size()))
                throw MeshError("the stored mesh has sizes of other nodes");
        sizes =
            std::make_shared<const NodalSizes>(std::move(xy), std::move(cells), std::move(size));
    }

    void visit(Domain& domain) { domain.visit(*this); }
    void visit(SizeField& field) { field.visit(*this); }
    void visit(SizeFoci& foci) { (*this)(foci.places, foci.size, foci.slope, foci.largest); }
    void visit(RosetteRadii& radii) { (*this)(radii.usual, radii.at_end); }
    void visit(Network& network) { (*this)(network.first, network.xy, network.s_start); }

    void visit(Specification& spec) {
        (*this)(spec.domain, spec.size_fracture, spec.size_boundary, spec.is_window,
                spec.rosette_sectors, spec.rosette_radii, spec.fixed_points, spec.guides,
                spec.joint_size, spec.refined, spec.foci, spec.is_rough, spec.ring_slope,
                spec.own_size);
    }

    void visit(PlaneMesh& plane) {
        (*this)(plane.xy, plane.cells, plane.fracture_cells, plane.rosettes);
    }

    Mode mode_;
    char* place_;
    const char* end_;
    std::size_t size_ = 0;
};

void visit_all(Archive& archive, Mesh& mesh) {
    archive(mesh.specification, mesh.network, mesh.size, mesh.plane, mesh.split.tips);
}

void require(bool condition, const char* what) {
    if (!condition)
        throw MeshError(std::string("the stored mesh is not valid: ") + what);
}

void check_specification(const Specification& spec, std::size_t n_fractures) {
    require(
        (spec.own_size.empty() || spec.own_size.size() == n_fractures) &&
            (spec.rosette_radii.at_end.empty() || spec.rosette_radii.at_end.size() == n_fractures),
        "it has sizes of other fractures");
    spec.domain.check();
}

void check_network(const Network& network) {
    require(!network.first.empty() && network.first.front() == 0 &&
                network.first.back() == static_cast<int>(network.xy.size()) &&
                std::is_sorted(network.first.begin(), network.first.end()) &&
                network.s_start.size() + 1 == network.first.size(),
            "its network has other points");
}

void check_plane(const PlaneMesh& plane, int n_fractures) {
    const std::size_t n = plane.xy.size();
    for (const Triangle& cell : plane.cells)
        require(are_within(cell, n), "a cell has no such node");
    for (const FractureCell& cell : plane.fracture_cells)
        require(are_within(cell.node, n) && cell.fracture >= 0 && cell.fracture < n_fractures,
                "a fracture cell has no such node or fracture");
    for (const Rosette& rosette : plane.rosettes)
        require(are_within(std::array{rosette.tip_node}, n), "a rosette has no such node");
}

// The mesh that is split, as it was made. Tips that have moved have their own directions and radii.
void split_again(Mesh& mesh) {
    const std::vector<Tip> tips = std::move(mesh.split.tips);
    mesh.split = split(mesh.plane, mesh.specification.domain);
    check_mesh(mesh.split, mesh.specification.domain);
    require(tips.size() == mesh.split.tips.size(), "it has other tips");
    for (std::size_t t = 0; t < tips.size(); ++t) {
        const Tip& made = mesh.split.tips[t];
        require(tips[t].point == made.point && tips[t].node == made.node &&
                    tips[t].fracture == made.fracture && tips[t].end == made.end,
                "it has other tips");
        mesh.split.tips[t] = tips[t];
    }
}

} // namespace

// Counting and storing change nothing.
std::size_t stored_size(const Mesh& mesh) {
    Archive archive(Mode::count, nullptr, nullptr);
    visit_all(archive, const_cast<Mesh&>(mesh));
    return archive.size();
}

void store(const Mesh& mesh, char* bytes) {
    Archive archive(Mode::store, bytes, bytes + stored_size(mesh));
    visit_all(archive, const_cast<Mesh&>(mesh));
}

Mesh load(const char* bytes, std::size_t n_bytes) {
    Mesh mesh;
    Archive archive(Mode::load, const_cast<char*>(bytes), bytes + n_bytes);
    visit_all(archive, mesh);
    if (!archive.is_at_end())
        throw MeshError("the stored mesh is followed by something else");
    check_network(mesh.network);
    check_specification(mesh.specification, mesh.network.first.size() - 1);
    check_plane(mesh.plane, mesh.network.size());
    split_again(mesh);
    return mesh;
}

} // namespace cpp_mesh
