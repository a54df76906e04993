# entoptic_driver_table(<folder> <output.cpp>): <folder>/drivers.list to C++. Folder `x` declares `extern const Driver x_driver;` in
# x/x_device.h; a line whose header does not exist stops with its path.
function(entoptic_driver_table folder output)
  file(STRINGS ${folder}/drivers.list driver_lines REGEX "^[ \t]*[^# \t]")
  set(driver_includes "")
  set(driver_entries "")
  foreach(line IN LISTS driver_lines)
    string(REGEX REPLACE "#.*" "" driver "${line}")
    string(STRIP "${driver}" driver)
    if(NOT driver MATCHES "^[a-z][a-z0-9_]*$")
      message(FATAL_ERROR "${folder}/drivers.list: '${driver}' is not a folder's name (lower case, digits, _).")
    endif()
    set(driver_header ${driver}/${driver}_device.h)
    if(NOT EXISTS ${folder}/${driver_header})
      message(FATAL_ERROR
        "${folder}/drivers.list names '${driver}', but there is no ${folder}/${driver_header}: add it or remove the line.")
    endif()
    string(APPEND driver_includes "#include \"drivers/${driver_header}\"\n")
    string(APPEND driver_entries "        &${driver}_driver,\n")
  endforeach()
  file(CONFIGURE OUTPUT ${output} CONTENT [[
// Made from drivers/drivers.list by drivers/driver_table.cmake.
#include "drivers/driver.h"

@driver_includes@
namespace entoptic::drivers {

const std::vector<const Driver*>& driver_table() {
    static const std::vector<const Driver*> table{
@driver_entries@    };
    return table;
}

}  // namespace entoptic::drivers
]] @ONLY)
endfunction()
