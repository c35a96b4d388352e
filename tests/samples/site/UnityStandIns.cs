// What the script of samples/site/pages/engines/unity.md uses of Unity, as little of it as compiles and runs under Mono, and a
// program that plays two frames: Recipe.exe FOLDER WEIGHT...
using System;
using System.Globalization;
using System.Reflection;

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
    }

    public struct Bounds
    {
        public Vector3 min, max;
        public void SetMinMax(Vector3 low, Vector3 high) { min = low; max = high; }
    }

    public class RequireComponent : Attribute
    {
        public RequireComponent(Type type) { }
    }

    public class Mesh
    {
        public Rendering.IndexFormat indexFormat;
        public Bounds bounds;
        public Vector3[] vertices;
        public int[] triangles;
        public void MarkDynamic() { }
        public void SetVertices(Vector3[] values) { vertices = values; }
        public void SetTriangles(int[] values, int part) { triangles = values; }
        public void RecalculateNormals() { }
    }

    public class MeshFilter { public Mesh mesh; }

    public class MonoBehaviour
    {
        static readonly MeshFilter filter = new MeshFilter();
        public T GetComponent<T>() where T : class { return filter as T; }
    }

    public static class Application { public static string streamingAssetsPath; }

    namespace Rendering
    {
        public enum IndexFormat { UInt16, UInt32 }
    }
}

static class Program
{
    static void Call(object target, string name)
    {
        target.GetType().GetMethod(name, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(target, null);
    }

    static void Print(string head, UnityEngine.Vector3 v)
    {
        Console.WriteLine(string.Format(CultureInfo.InvariantCulture, "{0} {1:R} {2:R} {3:R}", head, v.x, v.y, v.z));
    }

    static void Main(string[] arguments)
    {
        UnityEngine.Application.streamingAssetsPath = arguments[0];
        var character = new PliantCharacter();
        Call(character, "Start");
        for (int k = 0; k < character.weights.Length; ++k)
            character.weights[k] = float.Parse(arguments[k + 1], CultureInfo.InvariantCulture);
        Call(character, "Update");
        UnityEngine.Mesh mesh = character.GetComponent<UnityEngine.MeshFilter>().mesh;
        if (mesh.triangles.Length == 0) throw new Exception("no triangles");
        foreach (UnityEngine.Vector3 vertex in mesh.vertices) Print("v", vertex);
        Print("bounds", mesh.bounds.min);
        Print("bounds", mesh.bounds.max);
        Call(character, "OnDestroy");
    }
}
