// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// MINRES (Paige, Saunders 1975) of Belos, matrix-free: a vector type of ours with the operations that Belos
// asks for, and operators that call back into C. Guards against faults of Belos 13.2: a start that is
// already the solution makes it divide by zero, as does an exactly invariant subspace; its implicit test
// compares the preconditioner's norm with the 2-norm of r0, which agree after scaling M^-1 by
// |r0|^2 / <r0, M^-1 r0>; an exception of its own loses its text, which is read from its output instead.
#include "solver/belos_shim.h"

#include "core/shim.hpp"

extern "C" {
#include "core/memory.h"
}

#include <BelosLinearProblem.hpp>
#include <BelosMinresSolMgr.hpp>
#include <BelosMultiVecTraits.hpp>
#include <BelosOperatorTraits.hpp>
#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <cfloat>
#include <cmath>
#include <mutex>
#include <sstream>
#include <vector>

namespace {

// One vector: its own, or a view of a C array.
class Vector {
  public:
    explicit Vector(int n)
        : n(n), own(static_cast<double*>(ruga_allocate_zero(static_cast<size_t>(n) * sizeof(double)))),
          data(own) {
        if (!own) {
            throw ruga_status_thrown{ruga_fail(RUGA_NO_MEMORY, "out of memory in MINRES: %d unknowns", n)};
        }
    }
    Vector(int n, double* view) : n(n), own(nullptr), data(view) {}
    ~Vector() { ruga_release(own); }
    Vector(const Vector&) = delete;
    Vector& operator=(const Vector&) = delete;

  private:
    int n;
    double* own;

  public:
    double* data;
    int size() const { return n; }
};

double dot(const Vector& a, const Vector& b) {
    double sum = 0;
    for (int i = 0; i < a.size(); i++) {
        sum += a.data[i] * b.data[i];
    }
    return sum;
}

void copy(const Vector& from, Vector& to) {
    std::copy(from.data, from.data + from.size(), to.data);
}

// Thrown where Belos went on with a vector that is not finite: its x is still that of the last step.
struct Breakdown {};

struct Operator {
    ruga_operator* function;
    void* context;
    double scale;
    int* calls;
};

void apply(const Operator& op, const Vector& x, Vector& y) {
    if (!std::isfinite(dot(x, x))) {
        throw Breakdown();
    }
    ruga_status status = op.function(x.data, y.data, op.context);
    if (status != RUGA_OK) {
        throw ruga_status_thrown{status};
    }
    for (int i = 0; op.scale != 1 && i < y.size(); i++) {
        y.data[i] *= op.scale;
    }
    ++*op.calls;
}

} // namespace

namespace Belos {

template <> class MultiVecTraits<double, Vector> {
    typedef Teuchos::RCP<Vector> Pointer;
    typedef std::vector<int> Index;

  public:
    static Pointer Clone(const Vector& v, int) { return Teuchos::rcp(new Vector(v.size())); }
    static Pointer CloneCopy(const Vector& v) {
        Pointer c = Clone(v, 1);
        copy(v, *c);
        return c;
    }
    static Pointer CloneCopy(const Vector& v, const Index&) { return CloneCopy(v); }
    static Pointer CloneViewNonConst(Vector& v, const Index&) {
        return Teuchos::rcp(new Vector(v.size(), v.data));
    }
    static Teuchos::RCP<const Vector> CloneView(const Vector& v, const Index&) {
        return Teuchos::rcp(new Vector(v.size(), v.data));
    }
    static ptrdiff_t GetGlobalLength(const Vector& v) { return v.size(); }
    static int GetNumberVecs(const Vector&) { return 1; }
    static bool HasConstantStride(const Vector&) { return true; }
    static void MvTimesMatAddMv(double a, const Vector& x, const Teuchos::SerialDenseMatrix<int, double>& m,
                                double b, Vector& y) {
        MvAddMv(a * m(0, 0), x, b, y, y);
    }
    static void MvAddMv(double a, const Vector& x, double b, const Vector& y, Vector& z) {
        for (int i = 0; i < z.size(); i++) {
            z.data[i] = a * x.data[i] + b * y.data[i];
        }
    }
    static void MvScale(Vector& v, double a) {
        for (int i = 0; i < v.size(); i++) {
            v.data[i] *= a;
        }
    }
    static void MvScale(Vector& v, const std::vector<double>& a) { MvScale(v, a[0]); }
    static void MvTransMv(double a, const Vector& x, const Vector& y,
                          Teuchos::SerialDenseMatrix<int, double>& m) {
        m(0, 0) = a * dot(x, y);
    }
    static void MvDot(const Vector& x, const Vector& y, std::vector<double>& d) { d[0] = dot(x, y); }
    static void MvNorm(const Vector& v, std::vector<double>& norm, NormType = TwoNorm) {
        norm[0] = std::sqrt(dot(v, v));
    }
    static void SetBlock(const Vector& v, const Index&, Vector& to) { copy(v, to); }
    static void Assign(const Vector& v, Vector& to) { copy(v, to); }
    static void MvRandom(Vector& v) { MvInit(v, 1); } // only fills unused columns of a block
    static void MvInit(Vector& v, double a = 0) { std::fill(v.data, v.data + v.size(), a); }
    static void MvPrint(const Vector&, std::ostream&) {}
#ifdef HAVE_BELOS_TSQR
    typedef details::StubTsqrAdapter<Vector> tsqr_adaptor_type;
#endif
};

template <> class OperatorTraits<double, Vector, Operator> {
  public:
    static void Apply(const Operator& op, const Vector& x, Vector& y, ETrans = NOTRANS) { apply(op, x, y); }
    static bool HasApplyTranspose(const Operator&) { return false; }
};

} // namespace Belos

namespace {

typedef Belos::LinearProblem<double, Vector, Operator> Problem;
typedef Belos::MinresSolMgr<double, Vector, Operator> Solver;

// r = b - A x, and its norm.
double residual(const Operator& matrix, const Vector& b, const Vector& x, Vector& r) {
    apply(matrix, x, r);
    Belos::MultiVecTraits<double, Vector>::MvAddMv(1, b, -1, r, r);
    return std::sqrt(dot(r, r));
}

// The factor that makes the preconditioner's norm of r equal to its 2-norm.
double preconditioner_scale(const Operator& preconditioner, const Vector& r) {
    Vector z(r.size());
    apply(preconditioner, r, z);
    return dot(r, r) / dot(r, z);
}

Teuchos::RCP<Teuchos::ParameterList> parameters(double tolerance, int max_iterations, std::ostream& log) {
    Teuchos::RCP<Teuchos::ParameterList> list = Teuchos::rcp(new Teuchos::ParameterList);
    list->set("Convergence Tolerance", tolerance);
    list->set("Maximum Iterations", max_iterations);
    list->set("Verbosity", static_cast<int>(Belos::Errors));
    list->set("Output Stream", Teuchos::rcpFromRef(log));
    return list;
}

// Runs Belos. Afterwards x holds its last iterate, whether it met the tolerance or not.
int iterate(Operator& matrix, Operator* preconditioner, Vector& b, Vector& x, double tolerance,
            int max_iterations, std::ostream& log) {
    Teuchos::RCP<Problem> problem = Teuchos::rcp(
        new Problem(Teuchos::rcpFromRef(matrix), Teuchos::rcpFromRef(x), Teuchos::rcpFromRef(b)));
    if (preconditioner) {
        problem->setLeftPrec(Teuchos::rcpFromRef(*preconditioner));
    }
    problem->setHermitian();
    problem->setProblem();
    Solver solver(problem, parameters(tolerance, max_iterations, log));
    int calls = *matrix.calls;
    try {
        solver.solve();
    } catch (const Breakdown&) {
        return *matrix.calls - calls;
    }
    return solver.getNumIters();
}

ruga_status iterate_logged(Operator& matrix, Operator* preconditioner, Vector& b, Vector& x, double tolerance,
                           int max_iterations, int* iterations) {
    std::ostringstream log;
    try {
        *iterations = iterate(matrix, preconditioner, b, x, tolerance, max_iterations, log);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& thrown) {
        return ruga_fail(RUGA_LIBRARY, "MINRES of Belos failed: %s%s", thrown.what(), log.str().c_str());
    }
    return RUGA_OK;
}

ruga_status minres(Operator matrix, Operator* preconditioner, Vector& b, Vector& x, double tolerance,
                   int max_iterations, ruga_minres_report* report) {
    Vector r(b.size());
    double start = residual(matrix, b, x, r);
    if (!std::isfinite(start)) {
        return ruga_fail(RUGA_BAD_INPUT, "MINRES was given a matrix or vector that is not finite");
    }
    if (start <= DBL_EPSILON * std::sqrt(dot(b, b))) {
        report->converged = true; // to round-off
        return RUGA_OK;
    }
    report->residual = 1;
    if (preconditioner) {
        preconditioner->scale = preconditioner_scale(*preconditioner, r);
        if (!(preconditioner->scale > 0 && std::isfinite(preconditioner->scale))) {
            return ruga_fail(RUGA_LIBRARY, "the preconditioner for MINRES is not positive definite");
        }
    }
    if (max_iterations > 0) {
        ruga_status status =
            iterate_logged(matrix, preconditioner, b, x, tolerance, max_iterations, &report->iterations);
        if (status != RUGA_OK) {
            return status;
        }
    }
    report->residual = residual(matrix, b, x, r) / start;
    report->converged = report->residual <= tolerance;
    return RUGA_OK;
}

std::mutex one_at_a_time; // Teuchos counts its references without locks

} // namespace

ruga_status ruga_belos_minres(int n, ruga_operator* matrix, ruga_operator* preconditioner, void* context,
                              const double* b, double* x, double tolerance, int max_iterations,
                              ruga_minres_report* report) {
    *report = ruga_minres_report();
    RUGA_SHIM_BEGIN
    std::lock_guard<std::mutex> lock(one_at_a_time);
    int matrix_calls = 0, preconditioner_calls = 0;
    Operator m = {preconditioner, context, 1, &preconditioner_calls};
    Vector load(n, const_cast<double*>(b)), solution(n, x);
    return minres({matrix, context, 1, &matrix_calls}, preconditioner ? &m : nullptr, load, solution,
                  tolerance, max_iterations, report);
    RUGA_SHIM_END("Belos")
}
