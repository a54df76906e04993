# entoptic_shaders(<target> <file.comp>...): GLSL to SPIR-V, embedded as C arrays.
# `perception/glare/x.comp` becomes `generated/perception/glare/x.comp.h` with `static const uint32_t x_comp_spv[]`.
# Included GLSL is tracked by a depfile: touching a shared header rebuilds exactly its shaders.
function(entoptic_shaders target)
  set(outputs)
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE OUTPUT_VARIABLE path)
    file(RELATIVE_PATH relative ${CMAKE_SOURCE_DIR} ${path})
    get_filename_component(folder ${relative} DIRECTORY)
    get_filename_component(file ${relative} NAME)
    string(REPLACE "." "_" symbol ${file})
    set(output ${CMAKE_BINARY_DIR}/generated/${relative}.h)
    file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/generated/${folder})
    add_custom_command(
      OUTPUT ${output}
      COMMAND ${GLSLANG_VALIDATOR} --quiet --target-env vulkan1.2 -I${CMAKE_SOURCE_DIR} --depfile ${output}.d
              --vn ${symbol}_spv -o ${output} ${path}
      DEPENDS ${path}
      DEPFILE ${output}.d
      COMMENT "Shader ${relative}"
      VERBATIM)
    list(APPEND outputs ${output})
  endforeach()
  add_custom_target(${target}_shaders DEPENDS ${outputs})
  add_dependencies(${target} ${target}_shaders)
endfunction()
