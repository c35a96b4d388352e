// Bits.exe ASSETS GOLDEN MUSEUM: the C# file on the small assets of tests/runtime, on those of tests/golden and on the museum
// of bad files. Prints the hashes that test_bits.c prints, of the same blends. Exit code 1, and a message, where something is
// wrong.
using System;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Threading;
using Pliant;

static class Bits
{
    const ulong Start = 14695981039346656037ul;
    static ulong state;

    static ulong Hashed(ulong hash, float[] values, int count)
    {
        for (int i = 0; i < count; ++i)
            hash = unchecked((hash ^ BitConverter.ToUInt32(BitConverter.GetBytes(values[i]), 0)) * 1099511628211ul);
        return hash;
    }

    // As tests/runtime/support.h makes them.
    static ulong RandomBits()
    {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        return unchecked(state * 2685821657736338717ul);
    }

    static float[] RandomBlend(Asset asset)
    {
        int count = asset.Weights.Length;
        var weights = new float[count];
        for (int k = 0; k < count; ++k) weights[k] = (float)((float)(RandomBits() >> 40) / 16777216.0f + 1e-6f);
        for (int k = 0; asset.HasLayers && k < count; ++k)
        {
            float scaled = (float)(1.4f * weights[k]);
            weights[k] = (float)(scaled - 0.4f);
            if ((RandomBits() >> 32) % (ulong)count >= 3) weights[k] = 0;
        }
        return weights;
    }

    static void PrintBlend(string name, Asset asset, Character character, params float[] first)
    {
        int count = Math.Min(first.Length, asset.Weights.Length);
        float[] positions = new float[3 * asset.VertexCount], normals = new float[3 * asset.SurfaceVertexCount];
        var weights = new float[asset.Weights.Length];
        Array.Copy(first, weights, count);
        character.Reset();
        character.Solve(weights);
        character.Reconstruct(positions);
        character.ComputeNormals(positions, normals);
        string text = string.Join(",", first.Take(count).Select(w => w.ToString(CultureInfo.InvariantCulture)));
        Console.WriteLine("{0} {1} {2:x16} {3:x16}", name, text, Hashed(Start, positions, normals.Length),
                          Hashed(Start, normals, normals.Length));
    }

    static void PrintWalk(string name, Asset asset, Character character)
    {
        float[] positions = new float[3 * asset.VertexCount], normals = new float[3 * asset.SurfaceVertexCount];
        float[] weights = null;
        ulong hash = Start;
        state = 61;
        character.Reset();
        for (int frame = 0; frame < 30; ++frame)
        {
            if (frame % 6 == 0) weights = RandomBlend(asset);
            int k = frame % weights.Length;
            weights[k] = (float)(weights[k] + 0.03f);
            SolveInfo info = character.Solve(weights);
            character.Reconstruct(positions);
            character.ComputeNormals(positions, normals);
            hash = Hashed(hash, character.Coordinates, asset.Dimension);
            hash = Hashed(hash, new[] { info.Energy }, 1);
            hash = Hashed(hash, positions.Concat(normals).ToArray(), 24);
            hash = Hashed(hash, normals, normals.Length);
        }
        Console.WriteLine("{0} walk {1:x16}", name, hash);
    }

    static void PrintFolder(string folder)
    {
        string list = File.ReadAllText(Path.Combine(folder, "assets.txt"));
        foreach (string name in list.Split((char[])null, StringSplitOptions.RemoveEmptyEntries))
        {
            using (var asset = new Asset(File.ReadAllBytes(Path.Combine(folder, name + ".pliant"))))
            using (var character = new Character(asset))
            {
                PrintBlend(name, asset, character, 1f);
                PrintBlend(name, asset, character, 0.5f, 0.5f, 0.5f);
                PrintBlend(name, asset, character, 0.25f, 0.5f, 0.75f);
                PrintWalk(name, asset, character);
            }
        }
    }

    static void Refuses<T>(Action call, Func<T, bool> isRight, string what) where T : Exception
    {
        try
        {
            call();
        }
        catch (T error)
        {
            if (isRight(error)) return;
        }
        throw new Exception("not refused as it should be: " + what);
    }

    static void CheckErrors(string folder)
    {
        var asset = new Asset(File.ReadAllBytes(Path.Combine(folder, "strip_neo.pliant")));
        var character = new Character(asset);
        character.Solve(new[] { 1f, 1f });
        float[] before = (float[])character.Coordinates.Clone();
        Refuses<PliantException>(() => character.Solve(new[] { -1f, 1f }), e => e.Result == 41 && e.Message != "", "-1");
        Refuses<PliantException>(() => character.Solve(new[] { float.NaN, 1f }), e => e.Result == 40, "NaN");
        Refuses<ArgumentException>(() => character.Solve(new float[3]), e => e.Message.Contains("2 numbers"), "three weights");
        Refuses<ArgumentException>(() => character.Reconstruct(new float[3]), e => true, "three positions");
        Refuses<ArgumentNullException>(() => character.Solve(null), e => true, "null");
        Refuses<ArgumentOutOfRangeException>(() => asset.PoseName(-1), e => true, "pose -1");
        if (!before.SequenceEqual(character.Coordinates)) throw new Exception("an error changed the coordinates");
        float[] low = new float[3], high = new float[3];
        character.Bounds(low, high);
        if (!(low[0] < high[0]) || asset.Triangles().Max() >= asset.VertexCount) throw new Exception("box or triangles");
        asset.Dispose();
        Refuses<ObjectDisposedException>(() => character.Solve(new[] { 1f, 1f }), e => true, "an asset that is gone");
        character.Dispose();
        character.Dispose();
        Refuses<ObjectDisposedException>(() => character.Reset(), e => true, "a character that is gone");
    }

    // Calls that have begun end well, whatever is disposed of meanwhile, and one character does one thing at a time.
    static void CheckThreads(string folder)
    {
        byte[] bytes = File.ReadAllBytes(Path.Combine(folder, "strip_neo.pliant"));
        int refused = 0;
        for (int round = 0; round < 100; ++round)
        {
            var asset = new Asset(bytes);
            var character = new Character(asset);
            ThreadStart work = () =>
            {
                var positions = new float[3 * asset.VertexCount];
                for (int k = 0;; ++k)
                {
                    try
                    {
                        character.Solve(new[] { 1f, k % 7 });
                        character.Reconstruct(positions);
                    }
                    catch (InvalidOperationException error)
                    {
                        if (error is ObjectDisposedException) return;
                        Interlocked.Increment(ref refused);
                    }
                }
            };
            var threads = new[] { new Thread(work), new Thread(work) };
            foreach (Thread thread in threads) thread.Start();
            Thread.Sleep(1);
            if (round % 2 == 0) asset.Dispose();
            character.Dispose();
            foreach (Thread thread in threads) thread.Join();
            asset.Dispose();
        }
        if (refused == 0) throw new Exception("two threads worked with one character");
    }

    static void CheckMuseum(string folder)
    {
        int refused = 0;
        foreach (string path in Directory.GetFiles(folder, "*.pliant"))
        {
            try
            {
                new Asset(File.ReadAllBytes(path)).Dispose();
            }
            catch (PliantException)
            {
                ++refused;
            }
        }
        if (refused < 300) throw new Exception("only " + refused + " bad files were refused");
    }

    static int Main(string[] arguments)
    {
        PrintFolder(arguments[0]);
        PrintFolder(arguments[1]);
        CheckErrors(arguments[0]);
        CheckThreads(arguments[0]);
        CheckMuseum(arguments[2]);
        return 0;
    }
}
