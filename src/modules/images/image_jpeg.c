/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/images/images.h"

#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include "config.h"

bool vxm_picture_is_jpeg(const vxm_picture_file *file) {
  return file->size >= 3 && memcmp(file->data, "\xff\xd8\xff", 3) == 0;
}

#ifdef HAVE_JPEG

#include <jpeglib.h>

#include <jerror.h>

/** libjpeg leaves a failed call by longjmp. What is needed after it lies here, not in local variables. */
typedef struct jpeg_reader {
  struct jpeg_decompress_struct decoder;
  struct jpeg_error_mgr errors;
  jmp_buf failed;
  char message[JMSG_LENGTH_MAX];
  vxm_status status;
} jpeg_reader;

static void on_error(j_common_ptr decoder) {
  jpeg_reader *reader = decoder->client_data;
  decoder->err->format_message(decoder, reader->message);
  longjmp(reader->failed, 1);
}

static void on_message(j_common_ptr decoder) {
  (void)decoder;
}

/** Keeps the first warning; libjpeg goes on where data are damaged or end early. Bytes too many between the
 * parts of a file are a habit of cameras, and harm nothing. */
static void on_warning(j_common_ptr decoder, int level) {
  jpeg_reader *reader = decoder->client_data;
  bool is_harmless = decoder->err->msg_code == JWRN_EXTRANEOUS_DATA;
  if (level < 0 && !is_harmless && decoder->err->num_warnings++ == 0)
    decoder->err->format_message(decoder, reader->message);
}

/** Rows of three bytes a pixel become four, from the last pixel to the first. */
static void widen(unsigned char *row, size_t width) {
  for (size_t x = width; x-- > 0;) {
    row[4 * x + 3] = 255;
    for (int c = 2; c >= 0; c--)
      row[4 * x + (size_t)c] = row[3 * x + (size_t)c];
  }
}

static void read_rows(jpeg_reader *reader, vxm_image *image) {
  struct jpeg_decompress_struct *decoder = &reader->decoder;
  while (decoder->output_scanline < decoder->output_height) {
    JSAMPROW row = image->bytes + 4 * (size_t)decoder->output_scanline * image->width;
    if (jpeg_read_scanlines(decoder, &row, 1) != 1)
      return;
    widen(row, image->width);
  }
}

static void read_all(jpeg_reader *reader, vxm_image *image, vxm_context *context,
                     const vxm_picture_file *file, vxm_error *error) {
  struct jpeg_decompress_struct *decoder = &reader->decoder;
  jpeg_create_decompress(decoder);
  decoder->client_data = reader;
  jpeg_mem_src(decoder, file->data, file->size);
  jpeg_read_header(decoder, TRUE);
  decoder->out_color_space = JCS_RGB;
  reader->status =
      vxm_picture_begin(image, context, decoder->image_width, decoder->image_height, file, error);
  if (reader->status != VXM_OK)
    return;
  jpeg_start_decompress(decoder);
  read_rows(reader, image);
  jpeg_finish_decompress(decoder);
}

vxm_status vxm_picture_read_jpeg(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                 vxm_error *error) {
  vxm_status status = VXM_OK;
  jpeg_reader *reader = vxm_try_calloc(context, 1, sizeof *reader, &status, error);
  if (!reader)
    return status;
  reader->decoder.err = jpeg_std_error(&reader->errors);
  reader->decoder.client_data = reader;
  reader->errors.error_exit = on_error;
  reader->errors.output_message = on_message;
  reader->errors.emit_message = on_warning;
  if (setjmp(reader->failed) == 0)
    read_all(reader, image, context, file, error);
  else
    reader->status = vxm_fail(error, VXM_ERROR_FORMAT, "damaged JPEG: %.160s", reader->message);
  if (reader->status == VXM_OK && reader->errors.num_warnings > 0)
    reader->status = vxm_fail(error, VXM_ERROR_FORMAT, "damaged JPEG: %.160s", reader->message);
  jpeg_destroy_decompress(&reader->decoder);
  status = reader->status;
  vxm_free(context, reader);
  return status;
}

#else

vxm_status vxm_picture_read_jpeg(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                 vxm_error *error) {
  (void)image;
  (void)context;
  (void)file;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "this build reads no JPEG (Debian: libjpeg-dev)");
}

#endif
