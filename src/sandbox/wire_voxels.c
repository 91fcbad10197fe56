/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/wire_voxels.h"

#include <string.h>

/** Ahead of a key and its value. */
typedef struct text_sizes {
  uint64_t key, value;
} text_sizes;

typedef enum block_kind { BITS = 1, NUMBERS, CUBE } block_kind;

/** Ahead of the voxels of a block. */
typedef struct block_head {
  uint32_t kind;
  int32_t at[3];
  int32_t side; /**< of a cube */
  float number; /**< likewise */
} block_head;

/** Bytes of the voxels behind a head; a cube has none. */
static size_t voxel_bytes(uint32_t kind) {
  return kind == BITS      ? VXM_SINK_SIDE * sizeof(uint64_t)
         : kind == NUMBERS ? VXM_SINK_VOXELS * sizeof(float)
                           : 0;
}

/* ---- Sending ---- */

static vxm_status sent(vxm_wire_sender *s, bool went, vxm_error *error) {
  s->is_gone |= !went;
  return s->is_gone ? vxm_fail(error, VXM_ERROR_IO, "the process that asked has gone") : VXM_OK;
}

static vxm_status send_text(void *payload, const char *key, size_t key_size, const char *value,
                            size_t value_size, vxm_error *error) {
  vxm_wire_sender *s = payload;
  const text_sizes sizes = {key_size, value_size};
  if (key_size > VXM_SINK_TEXT_MAX || value_size > VXM_SINK_TEXT_MAX - key_size)
    return VXM_OK;
  return sent(s,
              vxm_message_send_kind(s->channel, VXM_MESSAGE_TEXT) &&
                  vxm_message_send(s->channel, &sizes, sizeof sizes) &&
                  vxm_message_send(s->channel, key, key_size) &&
                  vxm_message_send(s->channel, value, value_size),
              error);
}

static vxm_status send_grid(void *payload, const vxm_sink_grid *grid, vxm_error *error) {
  vxm_wire_sender *s = payload;
  return sent(s,
              vxm_message_send_kind(s->channel, VXM_MESSAGE_GRID) &&
                  vxm_message_send(s->channel, grid, sizeof *grid),
              error);
}

static vxm_status send_extent(void *payload, const vxm_sink_extent *extent, vxm_error *error) {
  vxm_wire_sender *s = payload;
  return sent(s,
              vxm_message_send_kind(s->channel, VXM_MESSAGE_EXTENT) &&
                  vxm_message_send(s->channel, extent, sizeof *extent),
              error);
}

static void flush(vxm_wire_sender *s) {
  uint64_t size = s->used;
  if (size > 0 && !s->is_gone)
    s->is_gone = !(vxm_message_send_kind(s->channel, VXM_MESSAGE_BLOCKS) &&
                   vxm_message_send(s->channel, &size, sizeof size) &&
                   vxm_message_send(s->channel, s->batch, s->used));
  s->used = 0;
}

static void add(vxm_wire_sender *s, const block_head *head, const void *voxels) {
  size_t bytes = voxel_bytes(head->kind);
  if (s->used + sizeof *head + bytes > sizeof s->batch)
    flush(s);
  memcpy(s->batch + s->used, head, sizeof *head);
  if (bytes > 0)
    memcpy(s->batch + s->used + sizeof *head, voxels, bytes);
  s->used += sizeof *head + bytes;
}

static block_head head_of(block_kind kind, const int64_t at[3]) {
  return (block_head){.kind = kind, .at = {(int32_t)at[0], (int32_t)at[1], (int32_t)at[2]}};
}

static void send_bits(void *payload, const int64_t at[3], const uint64_t bits[8]) {
  const block_head head = head_of(BITS, at);
  add(payload, &head, bits);
}

static void send_numbers(void *payload, const int64_t at[3], const float numbers[VXM_SINK_VOXELS]) {
  const block_head head = head_of(NUMBERS, at);
  add(payload, &head, numbers);
}

static void send_cube(void *payload, const int64_t at[3], int64_t side, float number) {
  block_head head = head_of(CUBE, at);
  head.side = (int32_t)side;
  head.number = number;
  add(payload, &head, NULL);
}

static vxm_status send_array(void *payload, const vxm_sink_array *array, vxm_error *error) {
  vxm_wire_sender *s = payload;
  return sent(s,
              vxm_message_send_kind(s->channel, VXM_MESSAGE_ARRAY) &&
                  vxm_message_send(s->channel, array, sizeof *array),
              error);
}

static vxm_status send_values(void *payload, const void *values, size_t size, vxm_error *error) {
  vxm_wire_sender *s = payload;
  for (const char *at = values; size > 0 && !s->is_gone;) {
    uint64_t part = size < VXM_WIRE_BATCH ? size : VXM_WIRE_BATCH;
    s->is_gone =
        !(vxm_message_send_kind(s->channel, VXM_MESSAGE_VALUES) &&
          vxm_message_send(s->channel, &part, sizeof part) && vxm_message_send(s->channel, at, part));
    at += part;
    size -= part;
  }
  return sent(s, !s->is_gone, error);
}

vxm_voxel_sink vxm_wire_sink(vxm_wire_sender *sender) {
  return (vxm_voxel_sink){.text = send_text,
                          .grid = send_grid,
                          .extent = send_extent,
                          .bits = send_bits,
                          .numbers = send_numbers,
                          .cube = send_cube,
                          .payload = sender,
                          .array = send_array,
                          .values = send_values};
}

bool vxm_wire_send_end(vxm_wire_sender *sender) {
  flush(sender);
  return !sender->is_gone && vxm_message_send_kind(sender->channel, VXM_MESSAGE_END);
}

/* ---- Receiving ---- */

static vxm_status receive_text(vxm_voxel_sink *sink, vxm_process *sender, vxm_error *error) {
  text_sizes sizes;
  vxm_status status = vxm_process_receive(sender, &sizes, sizeof sizes, error);
  if (status != VXM_OK)
    return status;
  if (sizes.key > VXM_SINK_TEXT_MAX || sizes.value > VXM_SINK_TEXT_MAX - sizes.key)
    return vxm_message_damaged(error);
  vxm_error local = VXM_ERROR_INIT;
  size_t key = (size_t)sizes.key, value = (size_t)sizes.value;
  char *both = vxm_alloc(sender->context, key + value, 1, &local);
  status = both ? vxm_process_receive(sender, both, key + value, &local) : local.code;
  if (status == VXM_OK)
    status = sink->text(sink->payload, both, key, both + key, value, &local);
  vxm_free(sender->context, both);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** A bool that came over may be any byte, which no bool can be. */
static bool is_bool(const bool *at) {
  unsigned char byte;
  memcpy(&byte, at, 1);
  return byte <= 1;
}

static vxm_status receive_grid(vxm_voxel_sink *sink, vxm_process *sender, vxm_error *error) {
  vxm_sink_grid grid;
  vxm_status status = vxm_process_receive(sender, &grid, sizeof grid, error);
  if (status != VXM_OK)
    return status;
  if (!is_bool(&grid.is_numbers) || !is_bool(&grid.has_space) || grid.grids == 0 || grid.at > INT64_MAX)
    return vxm_message_damaged(error);
  vxm_message_sanitize(grid.name, sizeof grid.name);
  return sink->grid(sink->payload, &grid, error);
}

/** Far less than 64 bits hold, so that differences of places do not overflow. */
static bool is_place(int64_t at) {
  return at >= INT32_MIN && at <= INT32_MAX;
}

static vxm_status receive_extent(vxm_voxel_sink *sink, vxm_process *sender, vxm_error *error) {
  vxm_sink_extent extent;
  vxm_status status = vxm_process_receive(sender, &extent, sizeof extent, error);
  if (status != VXM_OK)
    return status;
  bool is_sound = is_bool(&extent.is_empty);
  for (int a = 0; a < 3; a++)
    is_sound &= is_place(extent.low[a]) && is_place(extent.high[a]) && extent.low[a] <= extent.high[a];
  return is_sound ? sink->extent(sink->payload, &extent, error) : vxm_message_damaged(error);
}

/** Hands over one block; false if it is none. */
static bool take_block(vxm_voxel_sink *sink, const block_head *head, const unsigned char *voxels) {
  const int64_t at[3] = {head->at[0], head->at[1], head->at[2]};
  uint64_t bits[VXM_SINK_SIDE];
  float numbers[VXM_SINK_VOXELS];
  switch (head->kind) {
  case BITS:
    memcpy(bits, voxels, sizeof bits);
    sink->bits(sink->payload, at, bits);
    return true;
  case NUMBERS:
    memcpy(numbers, voxels, sizeof numbers);
    sink->numbers(sink->payload, at, numbers);
    return true;
  case CUBE:
    if (head->side < 1 || head->side > VXM_SINK_CUBE_MAX)
      return false;
    sink->cube(sink->payload, at, head->side, head->number);
    return true;
  default:
    return false;
  }
}

/** How many bytes a message has, and these: a batch at most. */
static vxm_status receive_batch(unsigned char batch[VXM_WIRE_BATCH], uint64_t *size, vxm_process *sender,
                                vxm_error *error) {
  vxm_status status = vxm_process_receive(sender, size, sizeof *size, error);
  if (status == VXM_OK && *size > VXM_WIRE_BATCH)
    status = vxm_message_damaged(error);
  return status == VXM_OK ? vxm_process_receive(sender, batch, (size_t)*size, error) : status;
}

static vxm_status receive_blocks(vxm_voxel_sink *sink, vxm_process *sender, vxm_error *error) {
  unsigned char batch[VXM_WIRE_BATCH];
  uint64_t size;
  vxm_status status = receive_batch(batch, &size, sender, error);
  for (size_t at = 0; status == VXM_OK && at < size;) {
    block_head head;
    if (size - at < sizeof head)
      return vxm_message_damaged(error);
    memcpy(&head, batch + at, sizeof head);
    at += sizeof head;
    if (size - at < voxel_bytes(head.kind) || !take_block(sink, &head, batch + at))
      return vxm_message_damaged(error);
    at += voxel_bytes(head.kind);
  }
  return status;
}

static vxm_status receive_array(vxm_voxel_sink *sink, vxm_process *sender, vxm_error *error) {
  vxm_sink_array array;
  vxm_status status = vxm_process_receive(sender, &array, sizeof array, error);
  if (status != VXM_OK)
    return status;
  bool is_sound = array.scalar <= VXM_INT64 && array.is_color <= 1 && array.known_place <= 3;
  for (int a = 0; a < 3; a++)
    is_sound &= array.shape[a] >= 1 && is_place(array.shape[a]);
  return is_sound ? sink->array(sink->payload, &array, error) : vxm_message_damaged(error);
}

static vxm_status receive_values(vxm_voxel_sink *sink, vxm_process *sender, vxm_error *error) {
  unsigned char batch[VXM_WIRE_BATCH];
  uint64_t size;
  vxm_status status = receive_batch(batch, &size, sender, error);
  return status == VXM_OK ? sink->values(sink->payload, batch, (size_t)size, error) : status;
}

vxm_status vxm_wire_receive_voxels(vxm_voxel_sink *sink, vxm_wire_arrival *arrival, uint64_t kind,
                                   vxm_process *sender, vxm_error *error) {
  if (kind == VXM_MESSAGE_TEXT && !arrival->has_grid)
    return receive_text(sink, sender, error);
  if (kind == VXM_MESSAGE_GRID && !arrival->has_grid && sink->grid) {
    arrival->has_grid = true;
    return receive_grid(sink, sender, error);
  }
  if (kind == VXM_MESSAGE_EXTENT && arrival->has_grid && !arrival->has_array && !arrival->has_extent) {
    arrival->has_extent = true;
    return receive_extent(sink, sender, error);
  }
  if (kind == VXM_MESSAGE_BLOCKS && arrival->has_extent)
    return receive_blocks(sink, sender, error);
  if (kind == VXM_MESSAGE_ARRAY && !arrival->has_grid && sink->array) {
    arrival->has_grid = arrival->has_array = true;
    return receive_array(sink, sender, error);
  }
  if (kind == VXM_MESSAGE_VALUES && arrival->has_array)
    return receive_values(sink, sender, error);
  arrival->is_whole = kind == VXM_MESSAGE_END && (arrival->has_extent || arrival->has_array);
  return arrival->is_whole ? VXM_OK : vxm_message_damaged(error);
}
