// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// CGAL behind plain C; see cgal_shim.h. One translation unit, because CGAL's templates are slow to compile.
// Its own checks are off in every build type: the mesh doctor has looked at the mesh, and one of them walks
// the whole mesh at every collapsed edge.
#define CGAL_NDEBUG
#include "core/shim.hpp" // first: it gives core/status.h its C linkage

#include "mesh/cgal_shim.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
using Vertex = Surface::Vertex_index;
using Face = Surface::Face_index;

static const char library[] = "CGAL";

static Point point_at(const double* x) {
    return Point(x[0], x[1], x[2]);
}

int ruga_cgal_orientation(const double a[3], const double b[3], const double c[3], const double d[3]) {
    return static_cast<int>(CGAL::orientation(point_at(a), point_at(b), point_at(c), point_at(d)));
}

ruga_status ruga_cgal_box_pairs(int count, const double (*box)[6], ruga_cgal_pair_function* pair,
                                void* context) {
    RUGA_SHIM_BEGIN
    using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;
    std::vector<Box> boxes;
    boxes.reserve(static_cast<size_t>(count));
    for (int i = 0; i < count; i++) {
        const double* b = box[i];
        boxes.emplace_back(CGAL::Bbox_3(b[0], b[1], b[2], b[3], b[4], b[5]), i);
    }
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [pair, context](const Box& a, const Box& b) {
        ruga_status status = pair(a.info(), b.info(), context);
        if (status != RUGA_OK) {
            throw ruga_status_thrown{status};
        }
    });
    return RUGA_OK;
    RUGA_SHIM_END(library)
}

using Triangle = Kernel::Triangle_3;
using Triangles = std::vector<Triangle>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

static Triangle triangle_at(const double* position, const int* v) {
    return Triangle(point_at(position + 3 * v[0]), point_at(position + 3 * v[1]),
                    point_at(position + 3 * v[2]));
}

struct ruga_cgal_locator {
    Triangles triangles;
    Tree tree;
};

ruga_status ruga_cgal_locator_create(const double* position, int triangle_count, const int* triangle,
                                     ruga_cgal_locator** locator) {
    *locator = nullptr;
    RUGA_SHIM_BEGIN
    auto made = std::make_unique<ruga_cgal_locator>();
    for (int f = 0; f < triangle_count; f++) {
        made->triangles.push_back(triangle_at(position, triangle + 3 * f));
    }
    made->tree.rebuild(made->triangles.cbegin(), made->triangles.cend());
    made->tree.build();
    *locator = made.release();
    return RUGA_OK;
    RUGA_SHIM_END(library)
}

void ruga_cgal_locator_destroy(ruga_cgal_locator** locator) {
    delete *locator;
    *locator = nullptr;
}

ruga_status ruga_cgal_locator_nearest(const ruga_cgal_locator* locator, int count, const double* point,
                                      int* face, double* nearest) {
    RUGA_SHIM_BEGIN
    for (int i = 0; i < count; i++) {
        auto found = locator->tree.closest_point_and_primitive(point_at(point + 3 * i));
        face[i] = static_cast<int>(found.second - locator->triangles.cbegin());
        for (int k = 0; k < 3; k++) {
            nearest[3 * i + k] = found.first[k];
        }
    }
    return RUGA_OK;
    RUGA_SHIM_END(library)
}

struct ruga_cgal_surface {
    Surface mesh;
    Surface::Property_map<Surface::Edge_index, bool> feature;
    Surface::Property_map<Vertex, bool> fixed;
    Surface::Property_map<Face, int> patch;
    std::vector<ruga_cgal_locator> origin; // of each patch, as it was

    ruga_cgal_surface()
        : feature(mesh.add_property_map<Surface::Edge_index, bool>("e:ruga_feature", false).first),
          fixed(mesh.add_property_map<Vertex, bool>("v:ruga_fixed", false).first),
          patch(mesh.add_property_map<Face, int>("f:ruga_patch", -1).first) {}
};

// Puts vertices back on their patch, on a side of it that faces their way: the nearest point of all may lie
// on the other side of a narrow gap or of a thin wall. Vertices on lines and borders are on the patch
// already.
struct Projection {
    const ruga_cgal_surface* surface;
    double reach;

    bool on_line(Vertex v) const {
        for (auto h : surface->mesh.halfedges_around_target(surface->mesh.halfedge(v))) {
            auto e = surface->mesh.edge(h);
            if (surface->mesh.is_border(e) || surface->feature[e]) {
                return true;
            }
        }
        return false;
    }

    Point facing(const Tree& tree, const Point& point, const Kernel::Vector_3& normal) const {
        std::vector<Triangles::const_iterator> near;
        tree.all_intersected_primitives(Kernel::Sphere_3(point, reach * reach), std::back_inserter(near));
        Point best = point;
        double least = std::numeric_limits<double>::max();
        for (auto triangle : near) {
            Point projected = Kernel().construct_projected_point_3_object()(*triangle, point);
            double distance = CGAL::squared_distance(point, projected);
            if (distance < least && triangle->supporting_plane().orthogonal_vector() * normal > 0) {
                best = projected;
                least = distance;
            }
        }
        return best;
    }

    Point operator()(Vertex v) const {
        const Point point = surface->mesh.point(v);
        if (on_line(v)) {
            return point;
        }
        const Tree& tree =
            surface
                ->origin[static_cast<size_t>(surface->patch[surface->mesh.face(surface->mesh.halfedge(v))])]
                .tree;
        auto normal = CGAL::Polygon_mesh_processing::compute_vertex_normal(v, surface->mesh);
        auto found = tree.closest_point_and_primitive(point);
        bool faces = found.second->supporting_plane().orthogonal_vector() * normal > 0;
        return faces ? found.first : facing(tree, point, normal);
    }
};

static void keep_origin(const ruga_cgal_surface_def& def, ruga_cgal_surface& surface) {
    int patches = 1 + *std::max_element(def.patch, def.patch + def.triangle_count);
    surface.origin = std::vector<ruga_cgal_locator>(static_cast<size_t>(patches));
    for (int f = 0; f < def.triangle_count; f++) {
        surface.origin[static_cast<size_t>(def.patch[f])].triangles.push_back(
            triangle_at(def.position, def.triangle + 3 * f));
    }
    for (ruga_cgal_locator& patch : surface.origin) {
        patch.tree.rebuild(patch.triangles.cbegin(), patch.triangles.cend());
        patch.tree.build();
    }
}

static void add_faces(const ruga_cgal_surface_def& def, ruga_cgal_surface& surface) {
    for (int v = 0; v < def.vertex_count; v++) {
        surface.fixed[surface.mesh.add_vertex(point_at(def.position + 3 * v))] = def.fixed[v];
    }
    for (int f = 0; f < def.triangle_count; f++) {
        const int* v = def.triangle + 3 * f;
        Face face =
            surface.mesh.add_face(Vertex(static_cast<unsigned>(v[0])), Vertex(static_cast<unsigned>(v[1])),
                                  Vertex(static_cast<unsigned>(v[2])));
        if (face == Surface::null_face()) {
            throw std::runtime_error("the mesh is not manifold at face " + std::to_string(f));
        }
        surface.patch[face] = def.patch[f];
    }
}

ruga_status ruga_cgal_surface_create(const ruga_cgal_surface_def* def, ruga_cgal_surface** surface) {
    *surface = nullptr;
    RUGA_SHIM_BEGIN
    auto made = std::make_unique<ruga_cgal_surface>();
    add_faces(*def, *made);
    keep_origin(*def, *made);
    CGAL::Polygon_mesh_processing::remove_isolated_vertices(
        made->mesh); // numbers stay until garbage collection
    for (int e = 0; e < def->feature_count; e++) {
        auto halfedge = made->mesh.halfedge(Vertex(static_cast<unsigned>(def->feature[e][0])),
                                            Vertex(static_cast<unsigned>(def->feature[e][1])));
        made->feature[made->mesh.edge(halfedge)] = true;
    }
    *surface = made.release();
    return RUGA_OK;
    RUGA_SHIM_END(library)
}

void ruga_cgal_surface_destroy(ruga_cgal_surface** surface) {
    delete *surface;
    *surface = nullptr;
}

ruga_status ruga_cgal_surface_remesh(ruga_cgal_surface* surface, double edge, int iterations,
                                     int relaxations) {
    RUGA_SHIM_BEGIN
    CGAL::Polygon_mesh_processing::isotropic_remeshing(
        surface->mesh.faces(), edge, surface->mesh,
        CGAL::parameters::number_of_iterations(static_cast<unsigned>(iterations))
            .number_of_relaxation_steps(static_cast<unsigned>(relaxations))
            .edge_is_constrained_map(surface->feature)
            .vertex_is_constrained_map(surface->fixed)
            .face_patch_map(surface->patch)
            .projection_functor(Projection{surface, edge}));
    surface->mesh.collect_garbage();
    return RUGA_OK;
    RUGA_SHIM_END(library)
}

void ruga_cgal_surface_edges(const ruga_cgal_surface* surface, double edge, double* mean, double* spread) {
    const Surface& mesh = surface->mesh;
    double sum = 0;
    double squares = 0;
    for (Surface::Edge_index e : mesh.edges()) {
        auto end = mesh.halfedge(e);
        double length =
            std::sqrt(CGAL::squared_distance(mesh.point(mesh.source(end)), mesh.point(mesh.target(end))));
        sum += length;
        squares += std::log(length / edge) * std::log(length / edge);
    }
    *mean = sum / static_cast<double>(mesh.number_of_edges());
    *spread = std::sqrt(squares / static_cast<double>(mesh.number_of_edges()));
}

int ruga_cgal_surface_vertex_count(const ruga_cgal_surface* surface) {
    return static_cast<int>(surface->mesh.number_of_vertices());
}

int ruga_cgal_surface_triangle_count(const ruga_cgal_surface* surface) {
    return static_cast<int>(surface->mesh.number_of_faces());
}

ruga_status ruga_cgal_surface_get(const ruga_cgal_surface* surface, double* position, int* triangle,
                                  int* patch) {
    RUGA_SHIM_BEGIN
    for (Vertex v : surface->mesh.vertices()) {
        for (int k = 0; k < 3; k++) {
            *position++ = surface->mesh.point(v)[k];
        }
    }
    for (Face f : surface->mesh.faces()) {
        for (Vertex v : surface->mesh.vertices_around_face(surface->mesh.halfedge(f))) {
            *triangle++ = static_cast<int>(v);
        }
        *patch++ = surface->patch[f];
    }
    return RUGA_OK;
    RUGA_SHIM_END(library)
}

using PlaneCorner = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using PlaneFace =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Plane =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               CGAL::Triangulation_data_structure_2<PlaneCorner, PlaneFace>,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;

static void read_plane(const Plane& cdt, ruga_cgal_plane* plane) {
    for (auto f : cdt.finite_face_handles()) {
        int k = f->info();
        for (int i = 0; i < 3; i++) {
            plane->triangle[k][i] = f->vertex(i)->info();
            plane->beside[k][i] = cdt.is_infinite(f->neighbor(i)) ? -1 : f->neighbor(i)->info();
            plane->firm[k][i] = f->is_constrained(i);
        }
    }
}

ruga_status ruga_cgal_triangulate(int point_count, const double (*point)[2], int segment_count,
                                  const int (*segment)[2], ruga_cgal_plane* plane) {
    RUGA_SHIM_BEGIN
    Plane cdt;
    std::vector<Plane::Vertex_handle> corner;
    for (int i = 0; i < point_count; i++) {
        size_t before = cdt.number_of_vertices();
        corner.push_back(cdt.insert(Kernel::Point_2(point[i][0], point[i][1])));
        corner.back()->info() = cdt.number_of_vertices() > before ? i : corner.back()->info();
    }
    for (int s = 0; s < segment_count; s++) {
        cdt.insert_constraint(corner[static_cast<size_t>(segment[s][0])],
                              corner[static_cast<size_t>(segment[s][1])]);
    }
    plane->triangle_count = 0;
    for (auto f : cdt.finite_face_handles()) {
        f->info() = plane->triangle_count++;
    }
    read_plane(cdt, plane);
    return RUGA_OK;
    RUGA_SHIM_END(library)
}
