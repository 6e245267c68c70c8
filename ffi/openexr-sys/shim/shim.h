/* What C says better than Rust: the library's initialiser macros, its anonymous unions and its
 * pipeline structs, whose layout differs between versions. Rust never sees those structs. */
#ifndef OPENEXR_SHIM_H
#define OPENEXR_SHIM_H

#include <openexr.h>

/* Samples of one channel in the caller's memory: `height` rows of `width` samples, without gaps. */
typedef struct openexr_shim_plane {
    const char *name;
    void *samples;
    int32_t width;
    int32_t height;
    exr_pixel_type_t type; /* also the type in the file */
} openexr_shim_plane;

/* Corners of a window, both inside it: x of the left column, y of the top row, x of the right
 * column, y of the bottom row. */
typedef struct openexr_shim_window {
    int32_t left;
    int32_t top;
    int32_t right;
    int32_t bottom;
} openexr_shim_window;

/* Opens a file for reading; `user_data` goes to each callback and must outlive the context. */
exr_result_t openexr_shim_start_read(exr_context_t *context, void *user_data,
                                     exr_read_func_ptr_t read, exr_query_size_func_ptr_t size,
                                     exr_error_handler_cb_t on_error);

/* Opens a file for writing; the same rule for `user_data`. */
exr_result_t openexr_shim_start_write(exr_context_t *context, void *user_data,
                                      exr_write_func_ptr_t write, exr_error_handler_cb_t on_error);

/* Sets what every part must have: rows from the top down, screen window of width 1 about 0. */
exr_result_t openexr_shim_set_required(exr_context_t context, const openexr_shim_window *data,
                                       const openexr_shim_window *display,
                                       float pixel_aspect_ratio, exr_compression_t compression);

/* Windows of the first part. */
exr_result_t openexr_shim_get_windows(exr_const_context_t context, openexr_shim_window *data,
                                      openexr_shim_window *display);

/* Encodes and writes the chunk of rows that begins at row `y`. Every channel needs a plane that
 * holds at least the rows and columns of the chunk. Only reads the samples. */
exr_result_t openexr_shim_encode_scanlines(exr_context_t context, int32_t y,
                                           const openexr_shim_plane *planes, int32_t plane_count);

/* Reads and decodes one chunk into the planes, by channel name; channels without a plane are
 * skipped. Refuses a plane that is smaller than the chunk. */
exr_result_t openexr_shim_decode(exr_const_context_t context, const exr_chunk_info_t *chunk,
                                 const openexr_shim_plane *planes, int32_t plane_count);

#endif
