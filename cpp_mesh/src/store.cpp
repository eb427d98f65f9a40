#include "store.hpp"

#include "errors.hpp"

#include <cstring>
#include <memory>
#include <type_traits>

namespace cpp_mesh {

namespace {

enum class Mode { count, store, load };

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
        if (mode_ == Mode::load)
            sizes = std::make_shared<const NodalSizes>(std::move(xy), std::move(cells),
                                                       std::move(size));
    }

    void visit(Domain& domain) { domain.visit(*this); }
    void visit(SizeField& field) { field.visit(*this); }
    void visit(SizeFoci& foci) { (*this)(foci.places, foci.size, foci.slope, foci.largest); }
    void visit(RosetteRadii& radii) { (*this)(radii.usual, radii.at_end); }
    void visit(Network& network) { (*this)(network.first, network.xy, network.s_start); }

    void visit(FracturePoint& point) {
        (*this)(point.xy, point.plane_node, point.kind, point.cells, point.copies);
    }

    void visit(Specification& spec) {
        (*this)(spec.domain, spec.size_fracture, spec.size_boundary, spec.is_window,
                spec.rosette_sectors, spec.rosette_radii, spec.fixed_points, spec.guides,
                spec.joint_size, spec.refined, spec.refined_size, spec.foci, spec.is_rough,
                spec.ring_slope, spec.own_size);
    }

    void visit(PlaneMesh& plane) {
        (*this)(plane.xy, plane.cells, plane.fracture_cells, plane.rosettes);
    }

    void visit(SplitMesh& split) {
        (*this)(split.xy, split.cells, split.cell_faces, split.faces, split.fracture_cells,
                split.fracture_cell_points, split.fracture_cell_faces, split.points, split.tips);
    }

    Mode mode_;
    char* place_;
    const char* end_;
    std::size_t size_ = 0;
};

void visit_all(Archive& archive, Mesh& mesh) {
    archive(mesh.specification, mesh.network, mesh.size, mesh.plane, mesh.split);
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
    return mesh;
}

} // namespace cpp_mesh
