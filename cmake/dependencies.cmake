# Libraries, all from Debian 12. Each is an interface target that modules name; README says what each is for.
set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)
find_package(OpenMP REQUIRED COMPONENTS C)

# SuiteSparse has no package files in Debian.
find_path(SUITESPARSE_INCLUDE cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
add_library(suitesparse INTERFACE)
target_include_directories(suitesparse SYSTEM INTERFACE ${SUITESPARSE_INCLUDE})
foreach(name cholmod amd suitesparseconfig)
    find_library(SUITESPARSE_${name} ${name} REQUIRED)
    target_link_libraries(suitesparse INTERFACE ${SUITESPARSE_${name}})
endforeach()

find_library(METIS_LIBRARY metis REQUIRED)
add_library(metis INTERFACE)
target_link_libraries(metis INTERFACE ${METIS_LIBRARY})

find_library(OPENBLAS_LIBRARY openblas REQUIRED)
find_library(LAPACKE_LIBRARY lapacke REQUIRED)
find_path(OPENBLAS_INCLUDE openblas_config.h PATHS /usr/include/${CMAKE_LIBRARY_ARCHITECTURE}
    PATH_SUFFIXES openblas-pthread REQUIRED)
add_library(blas INTERFACE)
target_include_directories(blas SYSTEM INTERFACE ${OPENBLAS_INCLUDE})
target_link_libraries(blas INTERFACE ${LAPACKE_LIBRARY} ${OPENBLAS_LIBRARY})

find_library(ARPACK_LIBRARY arpack REQUIRED)
add_library(arpack INTERFACE)
target_link_libraries(arpack INTERFACE ${ARPACK_LIBRARY} blas)

list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
find_package(OpenVDB REQUIRED)

set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 REQUIRED COMPONENTS C)
if(HDF5_IS_PARALLEL)
    message(FATAL_ERROR "Ruga needs the serial HDF5: install libhdf5-dev")
endif()

# Belos without find_package(Trilinos), whose Debian files want many packages that are not used.
find_package(MPI REQUIRED COMPONENTS C)
find_path(TRILINOS_INCLUDE BelosMinresSolMgr.hpp PATH_SUFFIXES trilinos REQUIRED)
add_library(belos INTERFACE)
target_include_directories(belos SYSTEM INTERFACE ${TRILINOS_INCLUDE})
target_compile_definitions(belos INTERFACE OMPI_SKIP_MPICXX=1)
foreach(name teuchosnumerics teuchoscomm teuchosparameterlist teuchosremainder teuchoscore)
    find_library(TRILINOS_${name} trilinos_${name} REQUIRED)
    target_link_libraries(belos INTERFACE ${TRILINOS_${name}})
endforeach()
target_link_libraries(belos INTERFACE MPI::MPI_C)

find_package(CGAL REQUIRED QUIET)
find_package(embree 3 REQUIRED)
find_package(PNG REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(YAML REQUIRED IMPORTED_TARGET yaml-0.1)
pkg_check_modules(JANSSON REQUIRED IMPORTED_TARGET jansson)
pkg_check_modules(EXPAT REQUIRED IMPORTED_TARGET expat)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo cairo-svg)
find_path(UDUNITS_INCLUDE udunits2.h REQUIRED)
find_library(UDUNITS_LIBRARY udunits2 REQUIRED)
add_library(udunits INTERFACE)
target_include_directories(udunits SYSTEM INTERFACE ${UDUNITS_INCLUDE})
target_link_libraries(udunits INTERFACE ${UDUNITS_LIBRARY})
