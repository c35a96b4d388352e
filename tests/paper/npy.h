// Writes numpy's .npy files (format version 1.0): little-endian numbers, row-major.
#pragma once

#include "input/io/write_file.h"

#include <Eigen/Core>
#include <fmt/core.h>
#include <string>

namespace pliant {

template <class Scalar>
void write_npy(const std::string& path, const char* type, const Eigen::Matrix<Scalar, -1, -1, Eigen::RowMajor>& matrix)
{
    std::string header
        = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}", type, matrix.rows(), matrix.cols());
    header.resize((header.size() + 11 + 63) / 64 * 64 - 11,
                  ' '); // magic, version, length and newline: 11 bytes; 64-aligned in all
    header += '\n';
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += char(header.size() & 255);
    bytes += char(header.size() >> 8);
    bytes += header;
    bytes.append(reinterpret_cast<const char*>(matrix.data()), sizeof(Scalar) * std::size_t(matrix.size()));
    write_file_atomically(path, bytes);
}

} // namespace pliant
