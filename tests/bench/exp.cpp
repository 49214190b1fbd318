#include <chrono>
#include <cstdio>
#include <cstring>
#include <cstdlib>
#include <numeric>
#include <fstream>
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/hair/groom_generator.h"
#include "core/hair/hair_file.h"
#include "core/reference/error_bar.h"
#include "core/reference/tracer.h"
#include "core/reference/nearest_strand.h"
#include "core/volume/transmittance.h"
using namespace hairbake;
int main(int argc,char**argv){
  auto now=[]{return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();};
  std::string name=argv[1]; int voxels=argc>2?atoi(argv[2]):256; size_t V=argc>3?atoi(argv[3]):1500000;
  HairModel m; double t=now();
  if(name=="curly"||name=="straight"||name=="wavy"){GroomSettings s; s.vertices=V; s.style=name=="curly"?GroomStyle::curly:name=="wavy"?GroomStyle::wavy:GroomStyle::straight; m=generate_groom(s);}
  else m=read_hair(std::filesystem::path(name));
  StrandGeometry g=make_strand_geometry(m,{});
  printf("model %.2fs V=%zu seg=%zu\n",now()-t,g.vertex_count(),g.segment_count);
  Progress p;
  // reference cache
  std::string cache="/tmp/ref_"+(name.find('/')!=std::string::npos?std::string("file_")+name.substr(name.rfind('/')+1):name+std::to_string(V))+".bin";
  std::vector<uint32_t> vs; std::vector<float> ref;
  if(FILE*f=fopen(cache.c_str(),"rb")){size_t n; fread(&n,8,1,f); vs.resize(n);ref.resize(n);fread(vs.data(),4,n,f);fread(ref.data(),4,n,f);fclose(f);}
  else { t=now(); StrandScene sc(g,p); printf("scene %.2f\n",now()-t);
    Random r(7); std::vector<uint32_t> all; for(int i=0;i<3000;i++) all.push_back(r.next()*g.vertex_count());
    std::sort(all.begin(),all.end());
    t=now(); auto d=distance_to_other_strands(g,all,3); 
    int in=0; for(size_t i=0;i<all.size();i++){ if(d[i]<0) in++; if(d[i]>=1) vs.push_back(all[i]);} printf("dist %.2f inside %d kept %zu\n",now()-t,in,vs.size());
    if(vs.size()>2000) {std::vector<uint32_t> w; for(size_t i=0;i<2000;i++) w.push_back(vs[i*vs.size()/2000]); vs=w;}
    t=now(); ref=trace_transmittance(sc,vs,make_directions(DirectionSet::fibonacci,4096,0),p); double tt=now()-t; printf("trace %.2f = %.2f Mray/s\n",tt,vs.size()*4096/tt/1e6);
    // baseline
    std::vector<uint32_t> run; size_t S=g.strand_count(); for(size_t k=0;k<400;k++){size_t s=k*S/400; for(uint32_t v=g.strand_begin[s];v<g.strand_begin[s+1];v++) run.push_back(v);} t=now(); trace_transmittance(sc,run,make_directions(DirectionSet::fibonacci,100,0),p); tt=now()-t; printf("baseline %zu vertices %.2fs -> whole %.1f s\n",run.size(),tt,tt*g.vertex_count()/run.size());
    FILE*f2=fopen(cache.c_str(),"wb"); size_t n=vs.size(); fwrite(&n,8,1,f2);fwrite(vs.data(),4,n,f2);fwrite(ref.data(),4,n,f2);fclose(f2);}
  TransmittanceSettings ts; ts.voxels=voxels; if(argc>4) ts.directions=atoi(argv[4]);
  for(int rep=0;rep<2;rep++){ t=now(); auto r=bake_transmittance_volume(g,ts,p); double el=now()-t;
  std::vector<float> b; for(auto v:vs) b.push_back(r.average[v]); auto e=error_statistics(b,ref);
  double mean=0; for(float x:ref) mean+=x/ref.size();
  printf("%s h=%.4f bake %.3f s rmse %.4f bias %+.4f (meanA %.3f)\n",name.c_str(),r.voxel_size,el,e.rmse,e.bias,mean);
 if(rep==0&&getenv("BINS")){ auto d=distance_to_other_strands(g,vs,30); double wh=0; for(auto v:vs) wh+=g.widths[v]/r.voxel_size/vs.size(); printf("mean w/h %.3f\n",wh); 
  for(int bin=0;bin<8;bin++){ double lo[]={1,1.5,2,3,5,8,12,20,31}; std::vector<float> x,y; double m=0; for(size_t i=0;i<vs.size();i++) if(d[i]>=lo[bin]&&d[i]<lo[bin+1]){x.push_back(b[i]);y.push_back(ref[i]);m+=ref[i];} auto q=error_statistics(x,y); printf(" dist/w %.1f.. n %zu rmse %.4f bias %+.4f meanA %.3f\n",lo[bin],x.size(),q.rmse,q.bias,m/std::max<size_t>(1,x.size())); }
  for(int bin=0;bin<5;bin++){ std::vector<float> x,y; for(size_t i=0;i<vs.size();i++) if(ref[i]>=bin*.2&&ref[i]<=bin*.2+.2){x.push_back(b[i]);y.push_back(ref[i]);} auto q=error_statistics(x,y); printf(" A %.1f.. n %zu rmse %.4f bias %+.4f\n",bin*.2,x.size(),q.rmse,q.bias); }
  for(int bin=0;bin<4;bin++){ std::vector<float> x,y; for(size_t i=0;i<vs.size();i++){ auto it=std::upper_bound(g.strand_begin.begin(),g.strand_begin.end(),vs[i]); size_t st=it-g.strand_begin.begin()-1; double q=(vs[i]-g.strand_begin[st])/double(g.strand_begin[st+1]-1-g.strand_begin[st]); if(q>=bin*.25&&q<=bin*.25+.25){x.push_back(b[i]);y.push_back(ref[i]);}} auto q=error_statistics(x,y); printf(" along %.2f.. n %zu rmse %.4f bias %+.4f\n",bin*.25,x.size(),q.rmse,q.bias); }
 }
}
}
