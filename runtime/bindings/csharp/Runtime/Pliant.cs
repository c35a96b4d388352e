// Pliant for C#: the C runtime by P/Invoke, for .NET Standard 2.0, Mono and Unity. pliant.h is the manual of what lies below.
//
//     using (var asset = new Asset(File.ReadAllBytes("creature.pliant")))   // once per asset
//     using (var character = new Character(asset))                          // once per character
//     {
//         character.Solve(new[] { 0.25f, 0.75f });                          // once per frame
//         character.Reconstruct(positions);                                 // 3 * asset.VertexCount floats
//     }
//
// Errors: PliantException with the number of pliant_result, ArgumentException for arrays of a wrong length,
// ObjectDisposedException after Dispose(), InvalidOperationException for a character that works in another thread. A call
// that throws changes nothing. Threads: an asset may be shared, a character belongs to one thread at a time; Dispose() may be
// called in any, and calls that have begun end well. Solve, Reconstruct and ComputeNormals allocate nothing.
using System;
using System.Runtime.InteropServices;
using System.Text;
using System.Threading;

namespace Pliant
{
    /// <summary>What the C library refused.</summary>
    public sealed class PliantException : Exception
    {
        /// <summary>The number of pliant_result.</summary>
        public int Result { get; }

        internal PliantException(int result)
            : base(Native.Text(Native.pliant_result_text(result)))
        {
            Result = result;
        }

        internal static void Require(int result)
        {
            if (result != 0) throw new PliantException(result);
        }
    }

    /// <summary>A weight of a blend: its name, the range that the baker has measured, the weight to start with.</summary>
    public sealed class Weight
    {
        public string Name { get; internal set; }
        public float Low { get; internal set; }
        public float High { get; internal set; }
        public float Initial { get; internal set; }
    }

    /// <summary>How a frame was solved: pliant_solve_info.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct SolveInfo
    {
        /// <summary>0 converged, 1 stopped at a limit, 2 stalled.</summary>
        public int Status;
        public uint Iterations;
        public uint Evaluations;
        public float Energy;
        public float Gradient;
        /// <summary>How far weights of layers are outside of their ranges; 0 inside.</summary>
        public float Outside;
    }

    /// <summary>An opened asset. Its characters work no more after its Dispose().</summary>
    public sealed class Asset : IDisposable
    {
        internal readonly Memory memory; // of the view and behind it the bytes

        public int VertexCount { get; }
        /// <summary>Vertices on the surface; the first ones. Fewer than VertexCount for a solid only.</summary>
        public int SurfaceVertexCount { get; }
        public int TriangleCount { get; }
        public int Dimension { get; }
        public int PoseCount { get; }
        /// <summary>Weights add layers to pose 0; otherwise a blend is an average of the poses.</summary>
        public bool HasLayers { get; }
        public Weight[] Weights { get; }

        /// <summary>Copies the bytes of a .pliant file and opens them. Any bytes are safe.</summary>
        public Asset(byte[] bytes)
        {
            if (bytes == null) throw new ArgumentNullException(nameof(bytes));
            const uint verifyChecksums = 1;
            memory = new Memory((long)Native.pliant_asset_size(), bytes.Length);
            IntPtr view = memory.Start(0), blob = memory.Start(1);
            Marshal.Copy(bytes, 0, blob, bytes.Length);
            try
            {
                PliantException.Require(Native.pliant_asset_open(view, blob, (UIntPtr)bytes.Length, verifyChecksums));
            }
            catch
            {
                Dispose();
                throw;
            }
            VertexCount = (int)Native.pliant_asset_get_vertex_count(view);
            SurfaceVertexCount = (int)Native.pliant_asset_get_boundary_vertex_count(view);
            TriangleCount = (int)Native.pliant_asset_get_triangle_count(view);
            Dimension = (int)Native.pliant_asset_get_dimension(view);
            PoseCount = (int)Native.pliant_asset_get_pose_count(view);
            HasLayers = Native.pliant_asset_get_has_layers(view) != 0;
            Weights = ReadWeights(view);
        }

        static Weight[] ReadWeights(IntPtr view)
        {
            var weights = new Weight[Native.pliant_asset_get_weight_count(view)];
            for (uint i = 0; i < weights.Length; ++i)
            {
                PliantException.Require(Native.pliant_asset_weight(view, i, out Native.WeightFields fields));
                weights[i] = new Weight
                {
                    Name = Native.Text(fields.Name), Low = fields.Low, High = fields.High, Initial = fields.Initial
                };
            }
            return weights;
        }

        /// <summary>Vertex indices, three for each triangle: a copy.</summary>
        public int[] Triangles()
        {
            using (new Use(memory, nameof(Asset)))
            {
                var indices = new int[3 * TriangleCount];
                Marshal.Copy(Native.pliant_asset_get_triangles(memory.Start(0)), indices, 0, indices.Length);
                return indices;
            }
        }

        public string PoseName(int pose)
        {
            using (new Use(memory, nameof(Asset)))
            {
                IntPtr name = Native.pliant_asset_pose_name(memory.Start(0), (uint)pose);
                if (name == IntPtr.Zero) throw new ArgumentOutOfRangeException(nameof(pose));
                return Native.Text(name);
            }
        }

        /// <summary>The coordinates that reproduce a pose: a copy.</summary>
        public float[] PoseCoordinates(int pose)
        {
            using (new Use(memory, nameof(Asset)))
            {
                IntPtr coordinates = Native.pliant_asset_pose_coordinates(memory.Start(0), (uint)pose);
                if (coordinates == IntPtr.Zero) throw new ArgumentOutOfRangeException(nameof(pose));
                var copy = new float[Dimension];
                Marshal.Copy(coordinates, copy, 0, copy.Length);
                return copy;
            }
        }

        public void Dispose() => memory.Dispose();
    }

    /// <summary>One character: its solver, and what rebuilds its shape.</summary>
    public sealed class Character : IDisposable
    {
        readonly Asset asset;
        readonly Memory memory; // of the solver, the normals and their view
        readonly IntPtr solver;
        int isBusy;

        /// <summary>The reduced coordinates of the last blend; all 0 before the first.</summary>
        public float[] Coordinates { get; }

        public Character(Asset asset)
        {
            this.asset = asset ?? throw new ArgumentNullException(nameof(asset));
            using (new Use(asset.memory, nameof(Asset)))
            {
                IntPtr view = asset.memory.Start(0);
                Native.pliant_solver_desc_init(out Native.SolverDesc desc);
                UIntPtr size = Native.pliant_solver_memory(view, ref desc);
                UIntPtr normalsSize = Native.pliant_normals_memory(view);
                memory = new Memory((long)size, (long)normalsSize, (long)Native.pliant_normals_size());
                PliantException.Require(Native.pliant_solver_init(out solver, view, ref desc, memory.Start(0), size));
                PliantException.Require(Native.pliant_normals_init(memory.Start(2), view, memory.Start(1), normalsSize));
            }
            Coordinates = new float[asset.Dimension];
        }

        // A call of the native library: it alone, with all memory that it reads. Those that throw leave nothing behind.
        struct Call : IDisposable
        {
            readonly Character character;
            readonly Use own, shared;

            public Call(Character character)
            {
                if (Interlocked.Exchange(ref character.isBusy, 1) != 0)
                    throw new InvalidOperationException("the character works in another thread");
                this.character = character;
                own = shared = default(Use);
                try
                {
                    own = new Use(character.memory, nameof(Character));
                    shared = new Use(character.asset.memory, nameof(Asset));
                }
                catch
                {
                    Dispose();
                    throw;
                }
            }

            public void Dispose()
            {
                shared.Dispose();
                own.Dispose();
                Volatile.Write(ref character.isBusy, 0);
            }
        }

        static void CheckLength(Array array, long length, string name)
        {
            if (array == null) throw new ArgumentNullException(name);
            if (array.Length != length) throw new ArgumentException($"{length} numbers expected, not {array.Length}", name);
        }

        /// <summary>Blends elastically: one number for each of the asset's weights.</summary>
        public SolveInfo Solve(float[] weights)
        {
            CheckLength(weights, asset.Weights.Length, nameof(weights));
            using (new Call(this))
            {
                PliantException.Require(Native.pliant_solve(solver, weights, Coordinates, out SolveInfo info));
                return info;
            }
        }

        /// <summary>Writes x y z of all vertices.</summary>
        public void Reconstruct(float[] positions)
        {
            CheckLength(positions, 3L * asset.VertexCount, nameof(positions));
            using (new Call(this))
                Native.pliant_reconstruct(asset.memory.Start(0), Coordinates, 0, (uint)asset.VertexCount, positions,
                                          (UIntPtr)12);
        }

        /// <summary>Writes normals of the vertices on the surface, of length 1, for these positions of all vertices.</summary>
        public void ComputeNormals(float[] positions, float[] result)
        {
            CheckLength(positions, 3L * asset.VertexCount, nameof(positions));
            CheckLength(result, 3L * asset.SurfaceVertexCount, nameof(result));
            using (new Call(this))
                Native.pliant_normals_compute(memory.Start(2), positions, (UIntPtr)12, 0, (uint)asset.SurfaceVertexCount,
                                              result, (UIntPtr)12);
        }

        /// <summary>A box that holds the blend, without looking at the vertices: three floats each.</summary>
        public void Bounds(float[] lowest, float[] highest)
        {
            CheckLength(lowest, 3, nameof(lowest));
            CheckLength(highest, 3, nameof(highest));
            using (new Call(this))
                PliantException.Require(Native.pliant_bounds(asset.memory.Start(0), Coordinates, lowest, highest));
        }

        /// <summary>For cuts and teleports: the next frame starts anew.</summary>
        public void Reset()
        {
            using (new Call(this)) Native.pliant_solver_reset(solver);
        }

        public void Dispose() => memory.Dispose();
    }

    /// <summary>Blocks that the collector does not move, at multiples of 16.</summary>
    sealed class Memory : SafeHandle
    {
        const int Alignment = 16;
        readonly long[] starts;

        public Memory(params long[] sizes)
            : base(IntPtr.Zero, true)
        {
            starts = new long[sizes.Length];
            long total = 0;
            for (int i = 0; i < sizes.Length; ++i)
            {
                starts[i] = total;
                total = RoundedUp(total + sizes[i]);
            }
            SetHandle(Marshal.AllocHGlobal((IntPtr)(total + Alignment)));
            for (int i = 0; i < sizes.Length; ++i) starts[i] += RoundedUp(handle.ToInt64());
        }

        // Addresses are negative above 2 GiB of a 32-bit process: a division would round them towards zero.
        static long RoundedUp(long number) => (number + Alignment - 1) & ~(Alignment - 1L);

        public IntPtr Start(int block) => (IntPtr)starts[block];

        public override bool IsInvalid => handle == IntPtr.Zero;

        protected override bool ReleaseHandle()
        {
            Marshal.FreeHGlobal(handle);
            return true;
        }
    }

    // Keeps memory while native code works in it, whatever another thread disposes of meanwhile.
    struct Use : IDisposable
    {
        readonly Memory memory;

        public Use(Memory memory, string owner)
        {
            bool isTaken = false;
            if (memory.IsClosed) throw new ObjectDisposedException(owner);
            memory.DangerousAddRef(ref isTaken); // throws for memory that was closed just now
            this.memory = memory;
        }

        public void Dispose() => memory?.DangerousRelease();
    }

    static class Native
    {
        const string Library = "pliant";

        [StructLayout(LayoutKind.Sequential)]
        internal struct SolverDesc
        {
            public uint StructSize, MaxIterations, MaxEvaluations;
            public float Tolerance, Continuity;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct WeightFields
        {
            public IntPtr Name;
            public float Low, High, Initial;
        }

        // UTF-8 that ends with a zero.
        internal static string Text(IntPtr start)
        {
            int length = 0;
            while (Marshal.ReadByte(start, length) != 0) ++length;
            var bytes = new byte[length];
            Marshal.Copy(start, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        const CallingConvention C = CallingConvention.Cdecl;

        [DllImport(Library, CallingConvention = C)] internal static extern IntPtr pliant_result_text(int result);
        [DllImport(Library, CallingConvention = C)] internal static extern UIntPtr pliant_asset_size();
        [DllImport(Library, CallingConvention = C)]
        internal static extern int pliant_asset_open(IntPtr asset, IntPtr blob, UIntPtr size, uint flags);
        [DllImport(Library, CallingConvention = C)] internal static extern uint pliant_asset_get_vertex_count(IntPtr asset);
        [DllImport(Library, CallingConvention = C)]
        internal static extern uint pliant_asset_get_boundary_vertex_count(IntPtr asset);
        [DllImport(Library, CallingConvention = C)] internal static extern uint pliant_asset_get_triangle_count(IntPtr asset);
        [DllImport(Library, CallingConvention = C)] internal static extern uint pliant_asset_get_dimension(IntPtr asset);
        [DllImport(Library, CallingConvention = C)] internal static extern uint pliant_asset_get_pose_count(IntPtr asset);
        [DllImport(Library, CallingConvention = C)] internal static extern uint pliant_asset_get_weight_count(IntPtr asset);
        [DllImport(Library, CallingConvention = C)] internal static extern uint pliant_asset_get_has_layers(IntPtr asset);
        [DllImport(Library, CallingConvention = C)] internal static extern IntPtr pliant_asset_get_triangles(IntPtr asset);
        [DllImport(Library, CallingConvention = C)]
        internal static extern int pliant_asset_weight(IntPtr asset, uint index, out WeightFields weight);
        [DllImport(Library, CallingConvention = C)]
        internal static extern IntPtr pliant_asset_pose_name(IntPtr asset, uint pose);
        [DllImport(Library, CallingConvention = C)]
        internal static extern IntPtr pliant_asset_pose_coordinates(IntPtr asset, uint pose);
        [DllImport(Library, CallingConvention = C)] internal static extern void pliant_solver_desc_init(out SolverDesc desc);
        [DllImport(Library, CallingConvention = C)]
        internal static extern UIntPtr pliant_solver_memory(IntPtr asset, ref SolverDesc desc);
        [DllImport(Library, CallingConvention = C)]
        internal static extern int pliant_solver_init(out IntPtr solver, IntPtr asset, ref SolverDesc desc, IntPtr memory,
                                                      UIntPtr size);
        [DllImport(Library, CallingConvention = C)] internal static extern void pliant_solver_reset(IntPtr solver);
        [DllImport(Library, CallingConvention = C)]
        internal static extern int pliant_solve(IntPtr solver, float[] weights, [In, Out] float[] q, out SolveInfo info);
        [DllImport(Library, CallingConvention = C)]
        internal static extern void pliant_reconstruct(IntPtr asset, float[] q, uint first, uint count,
                                                       [In, Out] float[] positions, UIntPtr stride);
        [DllImport(Library, CallingConvention = C)]
        internal static extern int pliant_bounds(IntPtr asset, float[] q, [In, Out] float[] lowest, [In, Out] float[] highest);
        [DllImport(Library, CallingConvention = C)] internal static extern UIntPtr pliant_normals_size();
        [DllImport(Library, CallingConvention = C)] internal static extern UIntPtr pliant_normals_memory(IntPtr asset);
        [DllImport(Library, CallingConvention = C)]
        internal static extern int pliant_normals_init(IntPtr normals, IntPtr asset, IntPtr memory, UIntPtr size);
        [DllImport(Library, CallingConvention = C)]
        internal static extern void pliant_normals_compute(IntPtr normals, float[] positions, UIntPtr stride, uint first,
                                                           uint count, [In, Out] float[] result, UIntPtr resultStride);
    }
}
