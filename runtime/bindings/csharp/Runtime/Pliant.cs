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
// ObjectDisposedException after Dispose(). A call that throws changes nothing. Threads: an asset may be shared, a character belongs to one
// thread at a time. Solve, Reconstruct and ComputeNormals allocate nothing.
using System;
using System.Runtime.InteropServices;
using System.Text;

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

    /// <summary>An opened asset. It must not be disposed of before its characters.</summary>
    public sealed class Asset : IDisposable
    {
        readonly Memory blob;
        readonly Memory view;

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
            blob = new Memory(bytes.Length);
            view = new Memory((long)Native.pliant_asset_size());
            Marshal.Copy(bytes, 0, blob.Start, bytes.Length);
            try
            {
                PliantException.Require(
                    Native.pliant_asset_open(view.Start, blob.Start, (UIntPtr)bytes.Length, verifyChecksums));
            }
            catch
            {
                Dispose();
                throw;
            }
            VertexCount = (int)Native.pliant_asset_get_vertex_count(view.Start);
            SurfaceVertexCount = (int)Native.pliant_asset_get_boundary_vertex_count(view.Start);
            TriangleCount = (int)Native.pliant_asset_get_triangle_count(view.Start);
            Dimension = (int)Native.pliant_asset_get_dimension(view.Start);
            PoseCount = (int)Native.pliant_asset_get_pose_count(view.Start);
            HasLayers = Native.pliant_asset_get_has_layers(view.Start) != 0;
            Weights = ReadWeights();
        }

        Weight[] ReadWeights()
        {
            var weights = new Weight[Native.pliant_asset_get_weight_count(view.Start)];
            for (uint i = 0; i < weights.Length; ++i)
            {
                PliantException.Require(Native.pliant_asset_weight(view.Start, i, out Native.WeightFields fields));
                weights[i] = new Weight
                {
                    Name = Native.Text(fields.Name), Low = fields.Low, High = fields.High, Initial = fields.Initial
                };
            }
            return weights;
        }

        internal IntPtr View
        {
            get
            {
                if (view.IsClosed) throw new ObjectDisposedException(nameof(Asset));
                return view.Start;
            }
        }

        /// <summary>Vertex indices, three for each triangle: a copy.</summary>
        public int[] Triangles()
        {
            var indices = new int[3 * TriangleCount];
            Marshal.Copy(Native.pliant_asset_get_triangles(View), indices, 0, indices.Length);
            GC.KeepAlive(this);
            return indices;
        }

        public string PoseName(int pose)
        {
            IntPtr name = Native.pliant_asset_pose_name(View, (uint)pose);
            if (name == IntPtr.Zero) throw new ArgumentOutOfRangeException(nameof(pose));
            string text = Native.Text(name);
            GC.KeepAlive(this);
            return text;
        }

        /// <summary>The coordinates that reproduce a pose: a copy.</summary>
        public float[] PoseCoordinates(int pose)
        {
            IntPtr coordinates = Native.pliant_asset_pose_coordinates(View, (uint)pose);
            if (coordinates == IntPtr.Zero) throw new ArgumentOutOfRangeException(nameof(pose));
            var copy = new float[Dimension];
            Marshal.Copy(coordinates, copy, 0, copy.Length);
            GC.KeepAlive(this);
            return copy;
        }

        public void Dispose()
        {
            view.Dispose();
            blob.Dispose();
        }
    }

    /// <summary>One character: its solver, and what rebuilds its shape.</summary>
    public sealed class Character : IDisposable
    {
        readonly Asset asset;
        readonly Memory memory;
        readonly Memory normals;
        readonly Memory normalsView;
        readonly IntPtr solver;

        /// <summary>The reduced coordinates of the last blend; all 0 before the first.</summary>
        public float[] Coordinates { get; }

        public Character(Asset asset)
        {
            this.asset = asset ?? throw new ArgumentNullException(nameof(asset));
            IntPtr view = asset.View;
            Native.pliant_solver_desc_init(out Native.SolverDesc desc);
            UIntPtr size = Native.pliant_solver_memory(view, ref desc);
            UIntPtr normalsSize = Native.pliant_normals_memory(view);
            memory = new Memory((long)size);
            normals = new Memory((long)normalsSize);
            normalsView = new Memory((long)Native.pliant_normals_size());
            PliantException.Require(Native.pliant_solver_init(out solver, view, ref desc, memory.Start, size));
            PliantException.Require(Native.pliant_normals_init(normalsView.Start, view, normals.Start, normalsSize));
            Coordinates = new float[asset.Dimension];
        }

        IntPtr View
        {
            get
            {
                if (memory.IsClosed) throw new ObjectDisposedException(nameof(Character));
                return asset.View;
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
            IntPtr view = View;
            CheckLength(weights, asset.Weights.Length, nameof(weights));
            PliantException.Require(Native.pliant_solve(solver, weights, Coordinates, out SolveInfo info));
            GC.KeepAlive(this);
            return info;
        }

        /// <summary>Writes x y z of all vertices.</summary>
        public void Reconstruct(float[] positions)
        {
            IntPtr view = View;
            CheckLength(positions, 3L * asset.VertexCount, nameof(positions));
            Native.pliant_reconstruct(view, Coordinates, 0, (uint)asset.VertexCount, positions, (UIntPtr)12);
            GC.KeepAlive(this);
        }

        /// <summary>Writes normals of the vertices on the surface, of length 1, for these positions of all vertices.</summary>
        public void ComputeNormals(float[] positions, float[] result)
        {
            IntPtr view = View;
            CheckLength(positions, 3L * asset.VertexCount, nameof(positions));
            CheckLength(result, 3L * asset.SurfaceVertexCount, nameof(result));
            Native.pliant_normals_compute(normalsView.Start, positions, (UIntPtr)12, 0, (uint)asset.SurfaceVertexCount,
                                          result, (UIntPtr)12);
            GC.KeepAlive(this);
        }

        /// <summary>A box that holds the blend, without looking at the vertices: three floats each.</summary>
        public void Bounds(float[] lowest, float[] highest)
        {
            IntPtr view = View;
            CheckLength(lowest, 3, nameof(lowest));
            CheckLength(highest, 3, nameof(highest));
            PliantException.Require(Native.pliant_bounds(view, Coordinates, lowest, highest));
            GC.KeepAlive(this);
        }

        /// <summary>For cuts and teleports: the next frame starts anew.</summary>
        public void Reset()
        {
            IntPtr view = View;
            Native.pliant_solver_reset(solver);
            GC.KeepAlive(this);
        }

        public void Dispose()
        {
            memory.Dispose();
            normals.Dispose();
            normalsView.Dispose();
        }
    }

    /// <summary>Memory that the collector does not move, at a multiple of 16.</summary>
    sealed class Memory : SafeHandle
    {
        const int Alignment = 16;

        public IntPtr Start { get; }

        public Memory(long size)
            : base(IntPtr.Zero, true)
        {
            SetHandle(Marshal.AllocHGlobal((IntPtr)(size + Alignment)));
            Start = (IntPtr)((handle.ToInt64() + Alignment - 1) / Alignment * Alignment);
        }

        public override bool IsInvalid => handle == IntPtr.Zero;

        protected override bool ReleaseHandle()
        {
            Marshal.FreeHGlobal(handle);
            return true;
        }
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
