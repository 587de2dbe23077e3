# A module is a folder: an object library ruga_<folder> that may use only the modules named in USES.
# Everything is put together in the library `ruga` (solver/, io/ and below) and the program `ruga`.
# Nobody asks for errno after mathematics, nor for floating-point exceptions: so loops with square roots and choices can
# use vector registers. No value changes by these options.
add_library(ruga_options INTERFACE)
target_include_directories(ruga_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
target_compile_options(ruga_options INTERFACE -ffp-contract=off
    $<$<COMPILE_LANGUAGE:C>:-fno-math-errno -fno-trapping-math -Wall -Wextra -Wpedantic -Wmissing-prototypes -Wvla>
    $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra>)
if(RUGA_WERROR)
    target_compile_options(ruga_options INTERFACE -Werror)
endif()
if(RUGA_SANITIZE)
    target_compile_options(ruga_options INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer
        -fno-sanitize-recover=undefined)
    target_link_options(ruga_options INTERFACE -fsanitize=address,undefined)
endif()

function(ruga_module name)
    cmake_parse_arguments(M "" "" "SOURCES;USES;LIBRARIES" ${ARGN})
    add_library(ruga_${name} OBJECT ${M_SOURCES})
    target_link_libraries(ruga_${name} PUBLIC ruga_options m ${M_LIBRARIES})
    foreach(used ${M_USES})
        target_link_libraries(ruga_${name} PUBLIC ruga_${used})
    endforeach()
    set_property(TARGET ruga_${name} PROPERTY RUGA_USES "${M_USES}")
endfunction()

# All modules that a module needs, itself included.
function(ruga_module_closure out)
    set(found "")
    set(open ${ARGN})
    while(open)
        list(POP_FRONT open name)
        if(NOT name IN_LIST found)
            list(APPEND found ${name})
            get_property(used TARGET ruga_${name} PROPERTY RUGA_USES)
            list(APPEND open ${used})
        endif()
    endwhile()
    set(${out} ${found} PARENT_SCOPE)
endfunction()

# The objects and libraries of modules, for an executable.
function(ruga_link target)
    ruga_module_closure(modules ${ARGN})
    foreach(name ${modules})
        target_sources(${target} PRIVATE $<TARGET_OBJECTS:ruga_${name}>)
        get_property(libraries TARGET ruga_${name} PROPERTY LINK_LIBRARIES)
        foreach(library ${libraries})
            if(NOT library MATCHES "^ruga_" OR library STREQUAL "ruga_options")
                target_link_libraries(${target} PRIVATE ${library})
            endif()
        endforeach()
    endforeach()
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)
endfunction()
