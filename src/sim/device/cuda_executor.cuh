#pragma once

#include <cstddef>
#include <cstdint>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <cuda_runtime.h>
#include <string>
#include <vector>

#include "sim/device/backend.hpp"

namespace talus::sim::device {

/// Errors: throws what the card said.
inline void check(cudaError_t status) {
    if (status == cudaSuccess) return;
    (void)cudaGetLastError();
    throw DeviceFailure(std::string("the graphics card failed (") + cudaGetErrorString(status) +
                        "): use --backend cpu, or fewer particles if its memory is full");
}

template <class Kernel>
__global__ void run_kernel(std::uint32_t count, Kernel kernel) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count) kernel(i);
}

inline constexpr std::uint32_t reduce_threads = 256, reduce_span = 4096;

/// Joins the values of `reduce_span` items per block, always in the same order.
template <class Value, class Kernel, class Join>
__global__ void reduce_part(std::uint32_t count, Value identity, Kernel kernel, Join join, Value* parts) {
    __shared__ alignas(16) unsigned char memory[reduce_threads * sizeof(Value)];
    Value* const shared = reinterpret_cast<Value*>(memory);
    const std::uint32_t first = blockIdx.x * reduce_span;
    const std::uint32_t last = count - first < reduce_span ? count : first + reduce_span;
    Value value = identity;
    for (std::uint32_t i = first + threadIdx.x; i < last; i += reduce_threads) value = join(value, kernel(i));
    shared[threadIdx.x] = value;
    __syncthreads();
    for (std::uint32_t half = reduce_threads / 2; half > 0; half /= 2) {
        if (threadIdx.x < half) shared[threadIdx.x] = join(shared[threadIdx.x], shared[threadIdx.x + half]);
        __syncthreads();
    }
    if (threadIdx.x == 0) parts[blockIdx.x] = shared[0];
}

/// Runs kernels on the graphics card; see HostExecutor. Kernels run one after the other; whatever reads a result waits
/// for those before it.
class CudaExecutor {
  public:
    CudaExecutor() = default;
    CudaExecutor(const CudaExecutor&) = delete;
    CudaExecutor& operator=(const CudaExecutor&) = delete;
    ~CudaExecutor() { (void)cudaFree(scratch_); }

    [[nodiscard]] static std::string name() {
        cudaDeviceProp properties{};
        check(cudaGetDeviceProperties(&properties, 0));
        return properties.name;
    }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }

    [[nodiscard]] void* allocate(std::size_t bytes) {
        void* memory = nullptr;
        check(cudaMalloc(&memory, bytes));
        bytes_ += bytes;
        return memory;
    }
    void release(void* memory, std::size_t bytes) {
        (void)cudaFree(memory);
        bytes_ -= bytes;
    }
    [[nodiscard]] Traffic traffic() const { return traffic_; }
    void upload(void* to, const void* from, std::size_t bytes) {
        traffic_.to_device += bytes;
        if (bytes > 0) check(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice));
    }
    void download(void* to, const void* from, std::size_t bytes) {
        traffic_.to_host += bytes;
        if (bytes > 0) check(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToHost));
    }
    static void copy(void* to, const void* from, std::size_t bytes) {
        if (bytes > 0) check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice));
    }

    template <class Kernel>
    static void for_each(std::size_t count, const Kernel& kernel) {
        if (count == 0) return;
        constexpr std::uint32_t threads = 128;
        const auto blocks = static_cast<std::uint32_t>((count + threads - 1) / threads);
        run_kernel<<<blocks, threads>>>(static_cast<std::uint32_t>(count), kernel);
        check(cudaGetLastError());
    }
    template <class Value, class Kernel, class Join>
    [[nodiscard]] Value reduce(std::size_t count, const Value& identity, const Kernel& kernel, const Join& join) {
        if (count == 0) return identity;
        const std::size_t blocks = (count + reduce_span - 1) / reduce_span;
        auto* const parts = static_cast<Value*>(scratch(blocks * sizeof(Value)));
        reduce_part<<<static_cast<std::uint32_t>(blocks), reduce_threads>>>(static_cast<std::uint32_t>(count), identity,
                                                                            kernel, join, parts);
        check(cudaGetLastError());
        std::vector<Value> results(blocks, identity);
        download(results.data(), parts, blocks * sizeof(Value));
        Value value = identity;
        for (const Value& part : results) value = join(value, part);
        return value;
    }
    std::uint32_t sum_up(std::uint32_t* values, std::size_t count) {
        check(cudaMemsetAsync(values + count, 0, sizeof *values));
        std::size_t bytes = 0;
        const auto items = static_cast<std::int64_t>(count + 1);
        check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, values, values, items));
        void* const memory = scratch(bytes);
        check(cub::DeviceScan::ExclusiveSum(memory, bytes, values, values, items));
        std::uint32_t sum = 0;
        download(&sum, values + count, sizeof sum);
        return sum;
    }
    void sort(std::uint64_t* keys, std::uint64_t* keys_swap, std::uint32_t* values, std::uint32_t* values_swap,
              std::size_t count, int bits) {
        cub::DoubleBuffer<std::uint64_t> key_pair(keys, keys_swap);
        cub::DoubleBuffer<std::uint32_t> value_pair(values, values_swap);
        std::size_t bytes = 0;
        const auto items = static_cast<std::int64_t>(count);
        check(cub::DeviceRadixSort::SortPairs(nullptr, bytes, key_pair, value_pair, items, 0, bits));
        void* const memory = scratch(bytes);
        check(cub::DeviceRadixSort::SortPairs(memory, bytes, key_pair, value_pair, items, 0, bits));
        if (key_pair.Current() != keys) copy(keys, key_pair.Current(), count * sizeof *keys);
        if (value_pair.Current() != values) copy(values, value_pair.Current(), count * sizeof *values);
    }

  private:
    /// Memory for the work of a single call.
    [[nodiscard]] void* scratch(std::size_t bytes) {
        if (bytes > scratch_size_) {
            release(scratch_, scratch_size_);
            scratch_ = nullptr;
            scratch_size_ = 0;
            scratch_ = allocate(bytes);
            scratch_size_ = bytes;
        }
        return scratch_;
    }

    std::size_t bytes_ = 0, scratch_size_ = 0;
    Traffic traffic_;
    void* scratch_ = nullptr;
};

}  // namespace talus::sim::device
