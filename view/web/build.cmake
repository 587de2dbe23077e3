# cmake -DSOURCE=view/web -DWORK=... -DOUTPUT=page_shell.c -DNONE=page_none.c -DNPM=... -DNODE=... -DREQUIRED=ON|OFF
#     -P build.cmake
# Brings the library of package-lock.json by npm and makes the page's shell. Where that fails, as it does without a
# network, the program is built without the page unless it is REQUIRED.
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json ${SOURCE}/shell.html ${SOURCE}/main.js ${SOURCE}/plots.js
    ${SOURCE}/build.mjs DESTINATION ${WORK})
set(log ${WORK}/npm.log)
execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=30000
    WORKING_DIRECTORY ${WORK} TIMEOUT 180 RESULT_VARIABLE result OUTPUT_FILE ${log} ERROR_FILE ${log})
if(result EQUAL 0)
    execute_process(COMMAND ${NODE} build.mjs ${OUTPUT} WORKING_DIRECTORY ${WORK} TIMEOUT 120 RESULT_VARIABLE result
        OUTPUT_FILE ${log} ERROR_FILE ${log})
endif()
if(NOT result EQUAL 0)
    if(REQUIRED)
        message(FATAL_ERROR "The page of `ruga view` could not be made (${result}): see ${log}")
    endif()
    message("-- `ruga view` is built without its page: npm failed (${result}); see ${log}")
    file(COPY_FILE ${NONE} ${OUTPUT})
endif()
