#include "gmsh_session.hpp"

#include "errors.hpp"

#include <gmsh.h>

#include <array>
#include <csignal>
#include <unordered_map>

namespace cpp_mesh {

namespace {

constexpr int algorithm_delaunay = 5, algorithm_frontal_delaunay = 6;

// Coordinates for gmsh: the region's box becomes about the unit square, so that gmsh's own absolute
// tolerances mean the same for a laboratory sample and for a reservoir.
struct Scaling {
    Vec2 centre;
    double factor = 1.0;

    Vec2 scaled(Vec2 p) const { return factor * (p - centre); }
    Vec2 original(Vec2 p) const { return centre + (1.0 / factor) * p; }
};

Scaling scaling_of(const std::vector<int>& loop, const std::vector<Vec2>& xy) {
    Vec2 low = xy[loop[0]], high = low;
    for (int node : loop) {
        low = {std::min(low.x, xy[node].x), std::min(low.y, xy[node].y)};
        high = {std::max(high.x, xy[node].x), std::max(high.y, xy[node].y)};
    }
    return {0.5 * (low + high), 1.0 / std::max(high.x - low.x, high.y - low.y)};
}

// Keeps what the program does about signals: gmsh sets handlers of its own when it starts, and a
// run that is told to stop would end without its last state. Signals wait until those are gone.
class KeptSignals {
public:
    KeptSignals() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_BLOCK, &all, &mask_);
        for (std::size_t k = 0; k < numbers.size(); ++k)
            sigaction(numbers[k], nullptr, &actions_[k]);
    }
    ~KeptSignals() {
        for (std::size_t k = 0; k < numbers.size(); ++k)
            sigaction(numbers[k], &actions_[k], nullptr);
        pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
    }
    KeptSignals(const KeptSignals&) = delete;
    KeptSignals& operator=(const KeptSignals&) = delete;

private:
    static constexpr std::array numbers = {SIGHUP, SIGINT,  SIGTERM, SIGSEGV,
                                           SIGBUS, SIGABRT, SIGFPE,  SIGPIPE};
    std::array<struct sigaction, numbers.size()> actions_;
    sigset_t mask_;
};

// One gmsh model, removed at the end whatever happens.
class Model {
public:
    Model() { gmsh::model::add("region"); }
    ~Model() {
        try {
            gmsh::model::mesh::removeSizeCallback();
            gmsh::model::remove();
        } catch (...) { // a destructor must not throw; the next model starts from nothing anyway
        }
    }
    Model(const Model&) = delete;
    Model& operator=(const Model&) = delete;
};

class RegionMesher {
public:
    RegionMesher(const Region& region, const SizeField& size, std::vector<Vec2>& xy,
                 double coverage)
        : region_(region), size_(size), xy_(xy), scaling_(scaling_of(region.loops.at(0), xy)),
          limit_(scaled_area(), coverage) {}

    std::vector<Triangle> run() {
        build_model();
        gmsh::model::mesh::setSizeCallback([this](int, int, double x, double y, double, double) {
            const double size = rounded_size(size_(scaling_.original({x, y})) * scaling_.factor);
            if (!limit_.allows(size)) // gmsh catches it, and is ready for the next region
                throw std::runtime_error(no_end);
            return size;
        });
        try {
            gmsh::model::mesh::generate(2);
        } catch (...) {
            if (limit_.is_reached())
                throw MeshError(no_end);
            throw;
        }
        collect_nodes();
        return collect_triangles();
    }

private:
    static constexpr const char* no_end =
        "gmsh was stopped: it tried far more nodes than the cell sizes require";

    double scaled_area() const {
        double twice = 0.0;
        for (const std::vector<int>& loop : region_.loops)
            for (std::size_t k = 0; k < loop.size(); ++k)
                twice += cross(scaling_.scaled(xy_[loop[k]]),
                               scaling_.scaled(xy_[loop[(k + 1) % loop.size()]]));
        return 0.5 * std::abs(twice);
    }

    // Rounding to fewer digits removes the rounding errors of the given places and of the sizes,
    // which differ between units of length, so that gmsh decides alike. Only gmsh sees it.
    Vec2 rounded_place(Vec2 p) const {
        if (!size_.is_scale_free())
            return p;
        constexpr double steps = 68719476736.0; // 2^36 in the region's extent
        return {std::round(p.x * steps) / steps, std::round(p.y * steps) / steps};
    }

    double rounded_size(double size) const {
        return size_.is_scale_free() ? static_cast<float>(size) : size;
    }

    int point(int node) {
        const auto [entry, is_new] = point_of_node_.try_emplace(node, 0);
        if (is_new) {
            const Vec2 p = rounded_place(scaling_.scaled(xy_[node]));
            entry->second = gmsh::model::geo::addPoint(p.x, p.y, 0.0);
            node_of_point_.push_back(node);
        }
        return entry->second;
    }

    int line(int a, int b) {
        const int tag = gmsh::model::geo::addLine(point(a), point(b));
        gmsh::model::geo::mesh::setTransfiniteCurve(tag, 2); // one element: no nodes are added
        return tag;
    }

    void build_model() {
        std::vector<int> loops;
        for (const std::vector<int>& loop : region_.loops) {
            std::vector<int> lines;
            for (std::size_t k = 0; k < loop.size(); ++k)
                lines.push_back(line(loop[k], loop[(k + 1) % loop.size()]));
            loops.push_back(gmsh::model::geo::addCurveLoop(lines));
        }
        surface_ = gmsh::model::geo::addPlaneSurface(loops);
        std::vector<int> embedded;
        for (const auto& edge : region_.embedded)
            embedded.push_back(line(edge[0], edge[1]));
        std::vector<int> points;
        for (int node : region_.points)
            points.push_back(point(node));
        gmsh::model::geo::synchronize();
        if (!embedded.empty())
            gmsh::model::mesh::embed(1, embedded, 2, surface_);
        if (!points.empty())
            gmsh::model::mesh::embed(0, points, 2, surface_);
    }

    void collect_nodes() {
        std::vector<std::size_t> tags;
        std::vector<double> coordinates, parameters;
        for (std::size_t k = 0; k < node_of_point_.size(); ++k) {
            const int node = node_of_point_[k];
            gmsh::model::mesh::getNodes(tags, coordinates, parameters, 0, point_of_node_.at(node));
            if (tags.size() != 1)
                throw MeshError("gmsh did not mesh a given point");
            node_of_tag_[tags[0]] = node;
        }
        gmsh::model::mesh::getNodes(tags, coordinates, parameters, 1);
        if (!tags.empty())
            throw MeshError("gmsh added nodes on given edges");
        gmsh::model::mesh::getNodes(tags, coordinates, parameters, 2, surface_);
        for (std::size_t k = 0; k < tags.size(); ++k) {
            node_of_tag_[tags[k]] = static_cast<int>(xy_.size());
            xy_.push_back(scaling_.original({coordinates[3 * k], coordinates[3 * k + 1]}));
        }
    }

    std::vector<Triangle> collect_triangles() const {
        constexpr int triangle_type = 2;
        std::vector<std::size_t> element_tags, node_tags;
        gmsh::model::mesh::getElementsByType(triangle_type, element_tags, node_tags, surface_);
        std::vector<Triangle> triangles(element_tags.size());
        for (std::size_t c = 0; c < triangles.size(); ++c) {
            for (int k = 0; k < 3; ++k)
                triangles[c][k] = node_of_tag_.at(node_tags[3 * c + k]);
            if (twice_area(xy_[triangles[c][0]], xy_[triangles[c][1]], xy_[triangles[c][2]]) < 0.0)
                std::swap(triangles[c][1], triangles[c][2]);
        }
        if (triangles.empty())
            throw MeshError("gmsh made no triangles");
        return triangles;
    }

    const Region& region_;
    const SizeField& size_;
    std::vector<Vec2>& xy_;
    const Scaling scaling_;
    WorkLimit limit_;
    std::unordered_map<int, int> point_of_node_;
    std::vector<int> node_of_point_;
    std::unordered_map<std::size_t, int> node_of_tag_;
    int surface_ = 0;
};

} // namespace

std::shared_ptr<GmshSession> GmshSession::shared() {
    static const std::shared_ptr<GmshSession> session = std::make_shared<GmshSession>();
    return session;
}

GmshSession::GmshSession() {
    const bool read_configuration = false, run = false;
    {
        const KeptSignals kept;
        gmsh::initialize(0, nullptr, read_configuration, run);
    }
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    for (const char* dimension : {"1D", "2D", "3D"})
        gmsh::option::setNumber(std::string("Mesh.MaxNumThreads") + dimension, 1);
    gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
    gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
    gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", 0);
}

GmshSession::~GmshSession() {
    try {
        gmsh::finalize();
    } catch (...) { // nothing can be done about it at the end of the process
    }
}

std::vector<Triangle> GmshSession::triangulate(const Region& region, const SizeField& size,
                                               std::vector<Vec2>& xy, double coverage) {
    const std::lock_guard lock(at_work_);
    try {
        const Model model;
        gmsh::option::setNumber("Mesh.Algorithm",
                                region.is_rough ? algorithm_delaunay : algorithm_frontal_delaunay);
        gmsh::option::setNumber("Mesh.Smoothing", region.is_rough ? 0 : 1);
        return RegionMesher(region, size, xy, coverage).run();
    } catch (const MeshError&) {
        throw;
    } catch (const std::exception& error) {
        throw MeshError(std::string("gmsh could not mesh the region: ") + error.what());
    } catch (const std::string& error) { // gmsh's own kind of exception
        throw MeshError("gmsh could not mesh the region: " + error);
    }
}

} // namespace cpp_mesh
